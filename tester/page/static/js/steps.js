// The steps around the present one: what each gave, how long it took or still takes. And the newest events.

import { h, put } from "./dom.js";
import { hms, spell, withU } from "./format.js";

const SIGNS = { done: "✓", now: "▶", later: "·" };
/** Events that are listed at once. */
const LISTED = 60;

/**
 * Return the list of a plan's steps.
 * @param {Object|null} plan PlanView
 * @param {Object|null} progress ProgressView
 * @param {Object[]} conditions of the run, for what a step gave
 * @returns {HTMLElement}
 */
export function stepList(plan, progress, conditions) {
  if (!plan || !plan.steps.length) return h("p", { class: "none", text: "No plan." });
  const gave = gaveOf(plan.steps, conditions, progress?.over ?? 0);
  const rows = plan.steps.map((step) => {
    const found = gave.get(step.number);
    const took =
      step.state === "done"
        ? `took ${spell(step.measured_s)}`
        : step.state === "now"
          ? `${spell(progress?.step_left_s)} left`
          : `${spell(step.expected_s)} expected`;
    const result = found && step.state !== "later" ? withU(found) : "";
    return h(
      "li",
      { class: `step ${step.state}`, "aria-current": step.state === "now" ? "step" : null },
      h("span", { class: "sign", "aria-hidden": "true", text: SIGNS[step.state] ?? "·" }),
      h(
        "span",
        { class: "what" },
        `${step.number}  ${step.title}`,
        result ? h("strong", { class: "gave", text: result }) : null,
        found?.state === "doubtful" ? h("span", { class: "doubt", text: ` ? ${found.doubt}` }) : null,
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

/**
 * Return what the listed steps gave, by step number: the conditions that are over, counted back from the present step.
 *
 * A step's title leaves out what it shares with the step before; its place in the plan is what identifies it.
 */
function gaveOf(steps, conditions, count) {
  const over = conditions.filter((one) => one.state !== "planned" && one.state !== "running").slice(0, count);
  const done = steps.filter((step) => step.kind === "condition" && step.state === "done");
  return new Map(done.reverse().map((step, index) => [step.number, over[over.length - 1 - index]]));
}
