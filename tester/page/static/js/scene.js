// What the service has told, bounded in size: a page that stays open for weeks holds no more than one of an hour.

/** Rows of the trend that are kept: ten minutes of snapshots (TREND_ROWS of the protocol). */
export const ROWS = 2400;
/** Events that are kept. */
export const EVENTS = 500;

/**
 * The live scene. `apply` takes a message of the service (docs/protocol.md) and returns its type.
 */
export class Scene {
  constructor() {
    this.machine = { kind: "", trend: ["wall_s", "t_s"], plots: [], axes: [], drawing: null, specimen: "specimen" };
    this.state = null;
    this.plan = null;
    this.queue = null;
    this.results = null;
    this.events = [];
    this.client = 0;
    this.life = "";
    this.trend = [];
  }

  /**
   * Take a message.
   * @param {Object} message
   * @returns {string} its type
   */
  apply(message) {
    switch (message.type) {
      case "hello":
        if (message.service !== this.life) this.events = [];
        this.life = message.service;
        this.client = message.client;
        this.machine = message.machine;
        this.state = message.state;
        this.plan = message.plan;
        this.queue = message.queue ?? null;
        this.results = message.results ?? null;
        this.trend = message.trend.slice(-ROWS);
        message.events.forEach((event) => this.#event(event));
        break;
      case "machine":
        this.machine = message.machine;
        this.trend = [];
        break;
      case "snapshot":
        this.state = message.state;
        this.#row(message.row);
        break;
      case "plan":
        this.plan = message.plan;
        break;
      case "results":
        this.results = message.results;
        break;
      case "queue":
        this.queue = message.queue;
        break;
      case "event":
        this.#event(message);
        break;
      default:
    }
    return message.type;
  }

  /** The results of the run that the state names; null where they are of another, or not known. */
  get given() {
    return this.results && this.results.run === this.state?.run?.name ? this.results : null;
  }

  #row(row) {
    const last = this.trend.at(-1);
    if (last && row[0] !== null && last[0] !== null && row[0] < last[0]) this.trend = []; // the service began anew
    this.trend.push(row);
    if (this.trend.length > ROWS + 200) this.trend.splice(0, this.trend.length - ROWS);
  }

  #event(event) {
    if (this.events.length && event.seq <= this.events.at(-1).seq) return;
    this.events.push(event);
    if (this.events.length > EVENTS) this.events.splice(0, this.events.length - EVENTS);
  }
}

/**
 * Return the column of a column's setpoint, -1 where there is none.
 *
 * A value comes before its setpoint (MachineView.trend).
 * @param {string[]} trend
 * @param {number} index
 * @returns {number}
 */
export function setpointOf(trend, index) {
  return index >= 0 && (trend[index + 1] ?? "").includes("_setpoint") ? index + 1 : -1;
}
