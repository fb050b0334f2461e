/** The people that face_recognizer knows: enrol somebody, look at them, forget them. */

const PICTURES = 10; // that are taken of somebody if nothing else is said
const SHOWN = 4; // pictures of each person
const TIMEOUT = 10; // s in which a node takes them, if it does not say
const TICK = 100; // ms, of the progress

const MISSING = "face_recognizer does not run, which knows faces by name. Start it with: "
  + "roslaunch robot_vision face_recognizer.launch";

const recognizers = (app) => (app.graph ? app.graph.nodes : [])
  .filter((one) => one.services.includes(`${one.name}/enroll`)).map((one) => one.name);

/** The panel while it is open. */
class FacesPanel {
  constructor(element, app) {
    this.app = app;
    this.node = "";
    this.closed = false;
    this._build(element);
    this.offs = [
      app.on("graph", () => this._look()), app.on("role", () => this._enable()),
      app.connection.whenOpen(() => this._list()),
    ];
    this._look();
  }

  _build(element) {
    const { el } = this.app;
    this.missing = el("div", { class: "empty", "data-test": "faces-missing" });
    this.name = el("input", {
      type: "text", maxlength: "60", required: "", placeholder: "Ada", "data-test": "face-name",
    });
    this.pictures = el("input", {
      type: "number", min: "1", max: "100", value: String(PICTURES), "data-test": "face-pictures",
    });
    this.enroll = el(
      "button", { class: "button primary", type: "submit", "data-test": "face-enroll" }, "Enrol",
    );
    this.bar = el("progress", { max: "1", value: "0", "data-test": "face-progress" });
    this.answer = el("p", { class: "dim", "aria-live": "polite", "data-test": "face-answer" });
    this.form = el(
      "form", { class: "stack" },
      el("p", {}, "Enrol: one person alone looks into the camera."),
      el("label", { class: "field" }, el("span", {}, "Name"), this.name),
      el("label", { class: "field" }, el("span", {}, "Images to take"), this.pictures),
      el("div", { class: "row" }, this.enroll, this.bar),
    );
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      this._enroll();
    });
    this.gallery = el("div", { class: "list", "data-test": "faces" });
    this.bar.hidden = true;
    this.present = el("div", { class: "stack" }, this.form, this.answer, this.gallery);
    element.append(this.missing, this.present);
  }

  _look() {
    const [node = ""] = recognizers(this.app);
    this.missing.hidden = Boolean(node);
    this.present.hidden = !node;
    this.missing.textContent = node ? "" : MISSING;
    this._enable();
    if (node === this.node) return;
    this.node = node;
    this._list();
  }

  _enable() {
    const controls = this.app.role === "control";
    for (const one of this.present.querySelectorAll("input, button")) {
      one.disabled = !controls || Boolean(this.busy && one.closest("form"));
    }
  }

  /** Shows who is known now. */
  async _list() {
    const { node } = this;
    if (!node || this.app.connection.state !== "open") return;
    await this._try(async () => {
      const { people } = await this.app.connection.request("faces", { node });
      if (this.closed || node !== this.node) return;
      this.gallery.replaceChildren(...(people.length
        ? people.map((person) => this._person(person))
        : [this.app.el("p", { class: "dim" }, "Nobody is known yet.")]));
      this._enable();
    });
  }

  _person({ name, pictures }) {
    const { el } = this.app;
    const images = el("div", { class: "row faces" });
    this._load(images, name, pictures);
    const forget = el(
      "button", { class: "button small", type: "button", "data-test": "face-forget" }, "Forget",
    );
    const row = el(
      "div", { class: "stack", "data-test": "face", "data-name": name },
      el(
        "div", { class: "row" }, el("strong", { class: "grow" }, name),
        el("span", { class: "badge" }, pictures === 1 ? "1 image" : `${pictures} images`), forget,
      ),
      images,
    );
    forget.addEventListener("click", () => this._confirm(row, forget, name));
    return row;
  }

  async _load(images, name, pictures) {
    for (let index = 0; index < Math.min(pictures, SHOWN); index++) {
      try {
        const fields = { node: this.node, name, index };
        const { jpeg } = await this.app.connection.request("face_picture", fields);
        const image = this.app.el("img", { class: "face", alt: `${name}, image ${index + 1}` });
        image.src = `data:image/jpeg;base64,${jpeg}`;
        images.append(image);
      } catch (error) {
        images.append(this.app.el("span", { class: "dim" }, error.message));
        return;
      }
      if (this.closed) return;
    }
  }

  /** Asks once more before a person's images are removed. */
  _confirm(row, forget, name) {
    const { el } = this.app;
    const sure = el(
      "button", { class: "button small danger", type: "button", "data-test": "face-forget-sure" },
      "Forget for good",
    );
    const keep = el("button", { class: "button small", type: "button" }, "Keep");
    const question = el(
      "div", { class: "row" }, el("span", { class: "grow" }, `Remove all images of ${name}?`),
      sure, keep,
    );
    forget.hidden = true;
    row.append(question);
    keep.focus();
    keep.addEventListener("click", () => {
      question.remove();
      forget.hidden = false;
    });
    sure.addEventListener("click", () => this._try(async () => {
      sure.disabled = true;
      const answer = await this.app.connection.request("forget_face", { node: this.node, name });
      this._say((answer && answer.message) || `${name} is forgotten`, "good");
      await this._list();
    }).then(() => {
      sure.disabled = false;
    }));
  }

  async _enroll() {
    const name = this.name.value.trim();
    if (!name || this.busy) return;
    this.busy = true;
    this._enable();
    this._say(`${name}: images are taken …`);
    const stop = this._progress(await this._timeout());
    await this._try(async () => {
      const fields = { node: this.node, name, pictures: Number(this.pictures.value) };
      const answer = await this.app.connection.request("enroll", fields);
      this._say((answer && answer.message) || `${name} is enrolled`, "good");
      this.name.value = "";
      await this._list();
    });
    stop();
    this.busy = false;
    this._enable();
  }

  /** s that the node takes for it at most. */
  async _timeout() {
    const { connection } = this.app;
    const { node } = this;
    try {
      const { values } = await connection.request("parameters", { node });
      connection.request("close_parameters", { node }).catch(() => {});
      return values.enroll_timeout || TIMEOUT;
    } catch {
      return TIMEOUT;
    }
  }

  /** Shows how much of the time is over, as nodes do not say how many images they have. */
  _progress(seconds) {
    const begin = performance.now();
    this.bar.hidden = false;
    const timer = setInterval(() => {
      this.bar.value = Math.min((performance.now() - begin) / 1000 / seconds, 1);
    }, TICK);
    return () => {
      clearInterval(timer);
      this.bar.hidden = true;
    };
  }

  async _try(work) {
    try {
      await work();
    } catch (error) {
      this._say(error.message, "bad");
    }
  }

  _say(text, kind) {
    if (this.closed) return;
    this.answer.textContent = text;
    if (kind) this.app.notify(text, kind);
  }

  close() {
    this.closed = true;
    this.offs.forEach((off) => off());
  }
}

export const tool = {
  name: "faces",
  title: "Faces",
  icon: "M12 12a4 4 0 1 0 0-8 4 4 0 0 0 0 8zM4 20c.8-3.6 4-5.5 8-5.5s7.2 1.9 8 5.5",
  available: () => true,
  open: (element, app) => {
    const panel = new FacesPanel(element, app);
    return () => panel.close();
  },
};
