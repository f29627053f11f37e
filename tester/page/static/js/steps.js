// The steps around the present one: what each gave, how long it took or still takes. And the newest events.

import { h, put } from "./dom.js";
import { hms, spell } from "./format.js";

const SIGNS = { done: "✓", now: "▶", later: "·" };
/** Events that are listed at once. */
const LISTED = 60;

/**
 * Return the list of a plan's steps.
 * @param {Object|null} plan PlanView
 * @param {Object|null} progress ProgressView
 * @param {Object|null} given GivenResults, for what a step gave
 * @returns {HTMLElement}
 */
export function stepList(plan, progress, given) {
  if (!plan || !plan.steps.length) return h("p", { class: "none", text: "No plan." });
  const gave = new Map((given?.conditions ?? []).map((one) => [one.condition, one]));
  const rows = plan.steps.map((step) => {
    const found = step.condition && step.state !== "later" ? gave.get(step.condition) : null;
    const grown = given?.growing?.condition === step.condition ? given.growing.grown.at(-1) : null;
    const took =
      step.state === "done"
        ? `took ${spell(step.measured_s)}`
        : step.state === "now"
          ? `${spell(progress?.step_left_s)} left`
          : `${spell(step.expected_s)} expected`;
    const result = step.state === "done" ? found?.text : grown?.text;
    return h(
      "li",
      { class: `step ${step.state}`, "aria-current": step.state === "now" ? "step" : null },
      h("span", { class: "sign", "aria-hidden": "true", text: SIGNS[step.state] ?? "·" }),
      h(
        "span",
        { class: "what" },
        `${step.number}  ${step.title}`,
        result ? h("strong", { class: "gave", text: result }) : null,
        found?.over && found.doubt ? h("span", { class: "doubt", text: ` ? ${found.doubt}` }) : null,
      ),
      h("span", { class: "time", text: took }),
    );
  });
  const before = plan.first > 1 ? h("li", { class: "step more", text: `${plan.first - 1} earlier steps` }) : null;
  const last = plan.first + plan.steps.length - 1;
  const after =
    plan.total > last
      ? h("li", { class: "step more", text: `${plan.total - last} later steps, ${spell(plan.beyond_s)}` })
      : null;
  const list = h("ol", { class: "steps" });
  put(list, before, ...rows, after);
  return list;
}

/**
 * Return the list of the newest events, the newest first.
 * @param {{t_s: number, kind: string, severity?: string, text: string}[]} events
 * @returns {HTMLElement}
 */
export function eventList(events) {
  if (!events.length) return h("p", { class: "none", text: "No events." });
  return h(
    "ol",
    { class: "events" },
    ...events
      .slice(-LISTED)
      .reverse()
      .map((event) =>
        h(
          "li",
          { class: event.severity ?? "info" },
          h("span", { class: "time", text: hms(event.t_s) }),
          h("span", { class: "kind", text: event.kind }),
          h("span", { class: "what", text: event.text }),
        ),
      ),
  );
}
