// Numbers, times and words for people. An unknown value is a dash, never an old value and never 0.

/** What stands for an unknown value. */
export const UNKNOWN = "–";
const MINUS = "−";

/**
 * Return a number with fixed digits and a true minus.
 * @param {number|null|undefined} value
 * @param {number} [decimals]
 * @returns {string}
 */
export function number(value, decimals = 3) {
  if (typeof value !== "number" || !Number.isFinite(value)) return UNKNOWN;
  const text = value.toFixed(decimals);
  return /^-0(\.0*)?$/.test(text) ? text.slice(1) : text.replace("-", MINUS);
}

/**
 * Return a value of any size with about four digits.
 * @param {any} value
 * @returns {string}
 */
export function short(value) {
  if (typeof value === "string") return value;
  if (typeof value !== "number" || !Number.isFinite(value)) return UNKNOWN;
  return String(Number(value.toPrecision(4))).replace("-", MINUS);
}

/**
 * Return a condition's or a repeat's coefficient, digit by digit as `tester show` prints it.
 * @param {{mu: number|null, mu_text?: string}} one
 * @returns {string}
 */
export function muText(one) {
  return typeof one.mu === "number" ? one.mu_text || number(one.mu) : UNKNOWN;
}

/**
 * Return its expanded uncertainty likewise.
 * @param {{u: number|null, u_text?: string}} one
 * @returns {string}
 */
export function uText(one) {
  return typeof one.u === "number" ? one.u_text || number(one.u) : UNKNOWN;
}

/**
 * Return a coefficient with its uncertainty.
 * @param {{mu: number|null, u: number|null, mu_text?: string, u_text?: string}} one
 * @returns {string}
 */
export function withU(one) {
  if (typeof one.mu !== "number") return UNKNOWN;
  return typeof one.u === "number" ? `${muText(one)} ± ${uText(one)}` : muText(one);
}

/**
 * Return seconds as h:mm:ss.
 * @param {number|null|undefined} seconds
 * @returns {string}
 */
export function hms(seconds) {
  if (typeof seconds !== "number" || !Number.isFinite(seconds)) return UNKNOWN;
  const whole = Math.max(Math.round(seconds), 0);
  const two = (n) => String(n).padStart(2, "0");
  return `${Math.floor(whole / 3600)}:${two(Math.floor(whole / 60) % 60)}:${two(whole % 60)}`;
}

/**
 * Return seconds in words: "3 h 20 min", "4 min", "12 s".
 * @param {number|null|undefined} seconds
 * @returns {string}
 */
export function spell(seconds) {
  if (typeof seconds !== "number" || !Number.isFinite(seconds)) return UNKNOWN;
  if (seconds < 90) return `${Math.max(Math.round(seconds), 0)} s`;
  const minutes = Math.round(seconds / 60);
  return minutes < 90 ? `${minutes} min` : `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

/**
 * Return a UTC stamp as this device's local time, with the day where it is not today.
 * @param {string} utc
 * @param {Date} [now]
 * @returns {string}
 */
export function local(utc, now = new Date()) {
  const at = new Date(utc);
  if (!utc || Number.isNaN(at.getTime())) return utc ? String(utc) : "";
  const two = (n) => String(n).padStart(2, "0");
  const time = `${two(at.getHours())}:${two(at.getMinutes())}`;
  if (at.toDateString() === now.toDateString()) return time;
  return `${at.getFullYear()}-${two(at.getMonth() + 1)}-${two(at.getDate())} ${time}`;
}

/** Modes in words (docs/protocol.md); an unknown mode is shown as it is. */
const MODES = {
  OFFLINE: "ready",
  INTERRUPTED: "a run was cut off",
  CONNECTING: "connecting",
  IDLE: "idle",
  ARMED: "armed",
  RUN: "running",
  HOLD: "on hold",
  STOPPING: "stopping",
  COOLDOWN: "cooling down",
  "FAST STOP": "fast stop",
  LATCHED: "stopped by a trip",
  "E-STOP": "emergency stop",
  MANUAL: "moved by hand",
};

/**
 * Return a mode in words.
 * @param {string} mode
 * @returns {string}
 */
export function inWords(mode) {
  return MODES[mode] ?? mode;
}

/**
 * Return an axis in words: "Load, N".
 * @param {{title: string, unit: string}} axis
 * @returns {string}
 */
export function axisText({ title, unit }) {
  return title.charAt(0).toUpperCase() + title.slice(1) + (unit ? `, ${unit}` : "");
}

/**
 * Return the names of stored runs, the newest first.
 * @param {{run: string, started_utc: string}[]} runs
 * @returns {string[]}
 */
export function newestFirst(runs) {
  const before = (a, b) => (a.started_utc < b.started_utc ? 1 : a.started_utc > b.started_utc ? -1 : 0);
  return [...runs].sort(before).map((run) => run.run);
}

/** Signs and words of a condition's or a repeat's state, told apart without colour. */
export const STATES = {
  planned: ["○", "planned"],
  running: ["◐", "running"],
  done: ["●", "measured"],
  doubtful: ["?", "in doubt"],
  refused: ["✕", "refused"],
  excluded: ["⊘", "excluded"],
  missing: ["∅", "no value"],
  valid: ["●", "valid"],
  "left out": ["✕", "left out"],
};

/**
 * Return [sign, word] of a state; an unknown state is shown as it is.
 * @param {string} state
 * @returns {[string, string]}
 */
export function sign(state) {
  return STATES[state] ?? ["·", state || "unknown"];
}
