// Pairing: a code from the machine's screen, once a device. And what this device may do.

import { button, field, h, put, say, table } from "./dom.js";
import { local } from "./format.js";
import { Refusal } from "./link.js";

const ROLES = { look: "looks only", stop: "looks and stops", control: "looks, stops, holds, changes the queue" };

/** The view before a device is paired. */
export class Pair {
  /** @param {Object} app */
  constructor(app) {
    this.app = app;
    this.code = /** @type {HTMLInputElement} */ (
      h("input", {
        inputmode: "numeric",
        autocomplete: "one-time-code",
        pattern: "[0-9]{6}",
        maxlength: 6,
        required: true,
        name: "code",
        class: "code",
      })
    );
    this.name = /** @type {HTMLInputElement} */ (
      h("input", { name: "device", maxlength: 60, required: true, autocomplete: "name", placeholder: "Anna's phone" })
    );
    this.keep = /** @type {HTMLInputElement} */ (h("input", { type: "checkbox", name: "keep" }));
    this.said = h("p", { class: "wants-text", role: "alert" });
    this.node = h(
      "section",
      { class: "panel pair", "aria-label": "Pair this device" },
      h("h1", { text: "Pair this device" }),
      h("p", {
        text:
          "The machine's screen shows a six-digit code: in the terminal where the page was started, and on F2 of the " +
          "operator's screen. Who can read it is at the machine.",
      }),
      h(
        "form",
        {
          onsubmit: (event) => {
            event.preventDefault();
            this.#pair();
          },
        },
        field("Code, six digits", this.code),
        field("Name of this device, for the list of who is paired", this.name),
        h(
          "label",
          { class: "tick" },
          this.keep,
          h("span", { text: "stay paired on this device when the tab is closed (12 h at most)" }),
        ),
        this.said,
        h("button", { type: "submit", class: "main", text: "Pair" }),
      ),
      h("p", {
        class: "small",
        text:
          "The code also fixes what this device may do: look, stop, or control. " +
          "STOP is on the page only once it is paired.",
      }),
    );
  }

  /** Write why a code is wanted. */
  update() {
    if (this.app.link.reason) say(this.said, this.app.link.reason);
  }

  async #pair() {
    say(this.said, "");
    try {
      await this.app.link.pair(this.code.value.trim(), this.name.value.trim(), this.keep.checked);
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      say(this.said, error.message);
    }
    this.code.value = "";
  }
}

/** The view of who is paired. */
export class Paired {
  /** @param {Object} app */
  constructor(app) {
    this.app = app;
    this.title = "Paired";
    this.mine = h("p");
    this.list = h("div");
    this.node = h(
      "section",
      { class: "panel", "aria-label": "Paired devices" },
      h("h2", { text: "Paired devices" }),
      this.mine,
      h(
        "p",
        { class: "buttons" },
        button("End the pairing of this device", () => this.app.link.leave()),
      ),
      this.list,
      h("p", {
        class: "small",
        text: "Pairings end after 12 h and with the page's process. Revoke others on F2 of the operator's screen.",
      }),
    );
  }

  /** Ask who is paired. */
  async open() {
    const { link } = this.app;
    say(
      this.mine,
      `This device${link.name ? ` (${link.name})` : ""} ${ROLES[link.role] ?? link.role}` +
        `${link.expires ? `, until ${local(link.expires)}` : ""}.`,
    );
    const found = await this.app.orders.ask("pairings");
    if (found?.pairings)
      put(
        this.list,
        table(
          "Who is paired",
          ["name", "may", "until"],
          found.pairings.map((one) => [one.name, ROLES[one.role] ?? one.role, local(one.expires_utc)]),
        ),
      );
  }
}
