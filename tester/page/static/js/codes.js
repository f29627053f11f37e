// Commands that may need the machine's code, and what came of them in words.

import { button, field, h, put, say } from "./dom.js";
import { Refusal } from "./link.js";

/** Sends commands; asks for a code where the page's process wants one; says what came of it. */
export class Orders {
  /**
   * @param {import("./link.js").Link} link
   * @param {HTMLElement} told where the outcome is written (role=status)
   */
  constructor(link, told) {
    this.link = link;
    this.told = told;
    this.late = 0;
  }

  /**
   * Send a command.
   * @param {Object} action
   * @param {string} done what to write once it is accepted
   * @returns {Promise<any>} its result; undefined where it was refused or given up
   */
  async send(action, done) {
    let code = "";
    let why = "";
    for (;;) {
      try {
        const result = await this.link.command(action, code);
        this.tell(done);
        return result ?? true;
      } catch (error) {
        if (!(error instanceof Refusal)) throw error;
        if (!error.message.startsWith("code:")) {
          this.tell(`Refused: ${error.message}`, true);
          return undefined;
        }
        why = error.message.slice(5).trim();
      }
      code = await askCode(why);
      if (!code) {
        this.tell("Given up: nothing was sent");
        return undefined;
      }
    }
  }

  /**
   * Ask the page's process; a refusal is written down.
   * @param {string} query
   * @param {Object} [more]
   * @param {string} [done]
   * @returns {Promise<any>} undefined where it was refused
   */
  async ask(query, more = {}, done = "") {
    try {
      const result = await this.link.ask(query, more);
      if (done) this.tell(done);
      return result ?? true;
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      this.tell(`Refused: ${error.message}`, true);
      return undefined;
    }
  }

  /**
   * Write an outcome; it goes by itself after 12 s, a refusal after 30 s.
   * @param {string} text
   * @param {boolean} [bad]
   */
  tell(text, bad = false) {
    clearTimeout(this.late);
    say(this.told, text);
    this.told.classList.toggle("bad", bad);
    this.late = window.setTimeout(() => say(this.told, ""), bad ? 30000 : 12000);
  }
}

/**
 * Ask for the code that the machine's screen shows.
 * @param {string} why
 * @returns {Promise<string>} "" where the person gives up
 */
function askCode(why) {
  const input = h("input", {
    inputmode: "numeric",
    autocomplete: "one-time-code",
    pattern: "[0-9]{6}",
    maxlength: 6,
    required: true,
    name: "code",
  });
  return dialog(
    "Code from the machine's screen",
    (close) => [
      h("p", { text: why || "This needs a new code. The machine's screen shows it now." }),
      h(
        "form",
        {
          onsubmit: (event) => {
            event.preventDefault();
            close(input.value.trim());
          },
        },
        field("Code, six digits", input),
        h(
          "p",
          { class: "buttons" },
          h("button", { type: "submit", class: "main", text: "Send" }),
          button("Give up", () => close("")),
        ),
      ),
    ],
    "",
  );
}

/**
 * Open a modal dialogue.
 * @template T
 * @param {string} title
 * @param {(close: (value: T) => void) => Node[]} content
 * @param {T} none value where it is left by Escape
 * @returns {Promise<T>}
 */
export function dialog(title, content, none) {
  return new Promise((resolve) => {
    const node = /** @type {HTMLDialogElement} */ (h("dialog", { "aria-labelledby": "dialog-title" }));
    const close = (value) => {
      node.close();
      node.remove();
      resolve(value);
    };
    node.addEventListener("cancel", (event) => {
      event.preventDefault();
      close(none);
    });
    put(node, h("h2", { id: "dialog-title", text: title }), ...content(close));
    document.body.append(node);
    node.showModal();
  });
}

/**
 * Ask for a reason in words.
 * @param {string} title
 * @param {string} verb text of the button
 * @returns {Promise<string>} "" where the person gives up
 */
export function askReason(title, verb) {
  const input = h("textarea", { rows: 3, maxlength: 2000, required: true, name: "reason" });
  return dialog(
    title,
    (close) => [
      h(
        "form",
        {
          onsubmit: (event) => {
            event.preventDefault();
            close(input.value.trim());
          },
        },
        field("Reason, goes on record", input),
        h(
          "p",
          { class: "buttons" },
          h("button", { type: "submit", class: "main", text: verb }),
          button("Give up", () => close("")),
        ),
      ),
    ],
    "",
  );
}
