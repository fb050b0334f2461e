/** Drawings of the page's own buttons: path data of 24x24 units. */
export const ICONS = {
  sliders: "M4 7h9m4 0h3M4 17h3m4 0h9M15 5v4M9 15v4",
  log: "M5 6h14M5 10h14M5 14h9M5 18h6",
  graph: "M4 5h5v4H4zM15 9h5v4h-5zM4 15h5v4H4zM9 7h3v4h3M9 17h3v-6",
  add: "M12 5v14M5 12h14",
  close: "M6 6l12 12M18 6L6 18",
  layout: "M4 5h7v6H4zM13 5h7v6h-7zM4 13h7v6H4zM13 13h7v6h-7z",
  sun:
    "M12 8a4 4 0 1 0 0 8 4 4 0 0 0 0-8zM12 2v2m0 16v2M2 12h2m16 0h2" +
    "M5 5l1.5 1.5m11 11L19 19M19 5l-1.5 1.5m-11 11L5 19",
  moon: "M20 14.5A8.5 8.5 0 0 1 9.5 4a8.5 8.5 0 1 0 10.5 10.5z",
  help: "M9 9a3 3 0 1 1 4.2 2.7c-.8.4-1.2 1-1.2 1.8v.5M12 17.5v.1",
  expand: "M14 4h6v6M20 4l-7 7M10 20H4v-6M4 20l7-7",
  shrink: "M20 10h-6V4M14 10l6-6M4 14h6v6M10 14l-6 6",
  more: "M5 12h.1M12 12h.1M19 12h.1",
  wide: "M4 5h16v14H4zM10 5v14",
  reset: "M5 12a7 7 0 1 1 2 5M5 12V7m0 5h5",
  pause: "M9 6v12M15 6v12",
  play: "M8 5l11 7-11 7z",
  down: "M12 5v14M6 13l6 6 6-6",
};
