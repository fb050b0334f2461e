/**
 * The WebSocket to the node: requests with answers, pushes, streams, and a new start whenever it is
 * lost.
 */

import { Channel, parseBinary } from "./channels.js";
import { Events } from "./events.js";

const MIN_DELAY = 500; // ms until the first new attempt
const MAX_DELAY = 10000; // ms
const PING_PERIOD = 5000; // ms
const SILENCE = 17000; // ms after a question without a word, when the connection is given up
const MAX_NUMBER = 65535;

/** The difference between two clocks, from the round trips that took least. */
export class ClockOffset {
  constructor() {
    /** @type {{roundTrip: number, offset: number}[]} */
    this.samples = [];
  }

  /**
   * @param {number} sent s, this clock
   * @param {number} received s, this clock
   * @param {number} time s, the other clock meanwhile
   */
  add(sent, received, time) {
    this.samples.push({ roundTrip: received - sent, offset: time - (sent + received) / 2 });
    if (this.samples.length > 12) this.samples.shift();
  }

  /** @returns {number} s, what is added to this clock's time */
  get offset() {
    if (!this.samples.length) return 0;
    return this.samples.reduce((a, b) => (b.roundTrip < a.roundTrip ? b : a)).offset;
  }
}

export class Connection {
  /** @param {string} url */
  constructor(url) {
    this.url = url;
    this.events = new Events();
    /** @type {"connecting"|"open"|"closed"} closed: waiting for the next attempt */
    this.state = "connecting";
    this.clock = new ClockOffset();
    /** @type {Map<number, Channel>} by their numbers */
    this.channels = new Map();
    /** @type {Set<Channel>} all that are wanted, also while there is no connection */
    this.wanted = new Set();
    this.pending = new Map();
    this.nextId = 1;
    this.nextNumber = 1;
    this.attempts = 0;
    this.nextAttempt = 0; // ms, performance.now() of the next attempt
    this.timer = 0;
    this.waitsSince = null; // ms, performance.now() of the first question since the last word
    setInterval(() => this.ping(), PING_PERIOD);
  }

  connect() {
    clearTimeout(this.timer);
    this.setState("connecting");
    const socket = new WebSocket(this.url);
    socket.binaryType = "arraybuffer";
    socket.onmessage = (event) => this.receive(socket, event.data);
    socket.onclose = () => this.lost(socket);
    this.socket = socket;
    this.waitsSince = performance.now();
  }

  /** Tries now instead of waiting. */
  retry() {
    if (this.state === "closed") this.connect();
  }

  setState(state) {
    this.state = state;
    this.events.emit("state", state);
  }

  lost(socket) {
    if (socket !== this.socket) return;
    this.socket = null;
    for (const { reject } of this.pending.values()) reject(new Error("The connection was lost."));
    this.pending.clear();
    this.channels.clear();
    const delay = Math.min(MAX_DELAY, MIN_DELAY * 2 ** this.attempts) * (0.8 + 0.4 * Math.random());
    this.attempts += 1;
    this.nextAttempt = performance.now() + delay;
    this.timer = setTimeout(() => this.connect(), delay);
    this.setState("closed");
  }

  receive(socket, data) {
    if (socket !== this.socket) return;
    this.waitsSince = null;
    if (data instanceof ArrayBuffer) {
      const message = parseBinary(data);
      this.channels.get(message.header.channel)?.receive(message, message.header);
      return;
    }
    const message = JSON.parse(data);
    if (message.push === "message")
      this.channels.get(message.channel)?.receive(message.data, message);
    else if (message.push) this.pushed(message.push, message.data);
    else this.answered(message);
  }

  pushed(kind, data) {
    if (kind === "hello") {
      this.attempts = 0;
      this.hello = data;
      this.events.emit("hello", data);
      this.setState("open");
      this.clock = new ClockOffset();
      for (let i = 0; i < 4; ++i) setTimeout(() => this.ping(), 150 * i);
      for (const channel of this.wanted) channel.open();
    } else if (kind === "channel_error") {
      this.channels.get(data.channel)?.onError(data.text);
    } else {
      this.events.emit("push:" + kind, data);
    }
  }

  answered(message) {
    const request = this.pending.get(message.id);
    if (!request) return;
    this.pending.delete(message.id);
    if (message.error === undefined) request.resolve(message.result);
    else request.reject(new Error(message.error));
  }

  send(message) {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  /**
   * @param {string} op
   * @param {Object} [fields]
   * @returns {Promise<any>} the result; rejected with the server's words
   */
  request(op, fields = {}) {
    if (this.state !== "open")
      return Promise.reject(new Error("There is no connection to the dashboard."));
    return new Promise((resolve, reject) => {
      const id = this.nextId++;
      this.pending.set(id, { resolve, reject });
      this.send({ op, id, ...fields });
    });
  }

  /**
   * What the server sends unasked; "hello" and "state" are told, too.
   * @param {string} kind
   * @param {(data: any) => void} callback
   * @returns {() => void} ends it
   */
  on(kind, callback) {
    return this.events.on(kind === "hello" || kind === "state" ? kind : "push:" + kind, callback);
  }

  /**
   * Calls something now, if there is a connection, and whenever there is one anew.
   * @param {() => void} work
   * @returns {() => void} ends it
   */
  whenOpen(work) {
    if (this.state === "open") work();
    return this.on("state", (state) => state === "open" && work());
  }

  /**
   * A stream, opened again after a lost connection.
   * @param {string} op image, points, messages or frames
   * @param {Object} fields without the channel's number
   * @param {(data: any, header: any) => void|Promise<void>} onData gets {header, payload}, or the
   *   message and its
   *   header {seq, stamp, received}; acknowledged when it is done
   * @param {(text: string) => void} [onError] why it is refused, and asked for again every few
   *   seconds, or why a message could not be read
   * @returns {() => void} closes it
   */
  channel(op, fields, onData, onError) {
    const channel = new Channel(this, op, fields, onData, onError);
    this.wanted.add(channel);
    if (this.state === "open") channel.open();
    return () => channel.close();
  }

  newNumber(channel) {
    do this.nextNumber = (this.nextNumber % MAX_NUMBER) + 1;
    while (this.channels.has(this.nextNumber));
    this.channels.set(this.nextNumber, channel);
    return this.nextNumber;
  }

  forget(channel) {
    this.wanted.delete(channel);
    this.channels.delete(channel.number);
  }

  /** Asks the server's time, or gives the connection up; a hidden page does so each minute only. */
  async ping() {
    const { socket, waitsSince } = this;
    if (socket && waitsSince !== null && performance.now() - waitsSince > SILENCE) {
      this.lost(socket);
      socket.close();
    } else if (this.state === "open") {
      this.waitsSince ??= performance.now();
      const sent = Date.now() / 1000;
      const answer = await this.request("ping").catch(() => null);
      if (answer) this.clock.add(sent, Date.now() / 1000, answer.time);
    }
  }

  /** @returns {number} s, what the server's clock shows now */
  serverTime() {
    return Date.now() / 1000 + this.clock.offset;
  }
}
