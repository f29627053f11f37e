// Regions and marks on the time axis: repeats, holds, alarms, wheel changes. Each kind has its sign and pattern.

import { scale, styled } from "./colours.js";

/** Sign, word and pattern of each kind; an unknown kind is a mark with a dot. */
export const KINDS = {
  repeat: { sign: "R", word: "repeat", fill: "--region", hatch: false },
  hold: { sign: "‖", word: "hold", fill: "--region-hold", hatch: true },
  alarm: { sign: "!", word: "alarm", fill: "--region-alarm", hatch: true },
  trip: { sign: "!", word: "trip", fill: "--region-alarm", hatch: true },
  wheel: { sign: "W", word: "wheel change", fill: "--region", hatch: true },
  prompt: { sign: "?", word: "question", fill: "--region-hold", hatch: false },
  step: { sign: "›", word: "step", fill: "--region", hatch: false },
  condition: { sign: "C", word: "condition", fill: "--region", hatch: false },
};
/** Kinds of marks that are drawn, and listed before others. */
export const DRAWN = new Set(["hold", "alarm", "trip", "wheel", "prompt"]);

/**
 * Return sign, word and pattern of a kind.
 * @param {string} kind
 * @returns {{sign: string, word: string, fill: string, hatch: boolean}}
 */
export function kindOf(kind) {
  return KINDS[kind] ?? { sign: "·", word: kind, fill: "--region", hatch: false };
}

/**
 * Return uPlot's hooks that draw regions below and marks above the lines.
 * @param {() => {regions: Object[], marks: Object[], cursor: number|null}} shown rig seconds
 * @param {boolean} labelled whether signs are written
 * @returns {Object}
 */
export function hooks(shown, labelled) {
  return {
    drawAxes: [(plot) => regions(plot, shown().regions, labelled)],
    draw: [(plot) => marks(plot, shown(), labelled)],
  };
}

function clipped(plot, draw) {
  const { ctx, bbox } = plot;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.font = `${Math.round(13 * devicePixelRatio * scale())}px system-ui, sans-serif`;
  ctx.textAlign = "left";
  ctx.textBaseline = "top";
  draw(ctx, bbox);
  ctx.restore();
}

function regions(plot, list, labelled) {
  if (!list.length) return;
  const { min, max } = plot.scales.x;
  clipped(plot, (ctx, box) => {
    for (const region of list) {
      const to = region.to_s ?? max;
      if (to < min || region.from_s > max || region.kind === "wheel") continue; // a wheel's beginning is a mark
      const left = plot.valToPos(Math.max(region.from_s, min), "x", true);
      const right = Math.max(plot.valToPos(Math.min(to, max), "x", true), left + 1);
      const kind = kindOf(region.kind);
      ctx.fillStyle = styled(kind.fill);
      ctx.fillRect(left, box.top, right - left, box.height);
      if (kind.hatch) hatch(ctx, left, right, box);
      const label = region.label ?? kind.sign;
      if (labelled && right - left > ctx.measureText(label).width + 6) {
        ctx.fillStyle = styled("--ink-2");
        ctx.fillText(label, left + 3, box.top + 3);
      }
    }
  });
}

function hatch(ctx, left, right, box) {
  const step = 10 * devicePixelRatio;
  ctx.save();
  ctx.beginPath();
  ctx.rect(left, box.top, right - left, box.height);
  ctx.clip();
  ctx.strokeStyle = styled("--hatch");
  ctx.lineWidth = devicePixelRatio;
  ctx.beginPath();
  for (let x = left - box.height; x < right; x += step) {
    ctx.moveTo(x, box.top + box.height);
    ctx.lineTo(x + box.height, box.top);
  }
  ctx.stroke();
  ctx.restore();
}

function marks(plot, { marks: list, regions: spans, cursor }, labelled) {
  const { min, max } = plot.scales.x;
  clipped(plot, (ctx, box) => {
    const wheels = spans.filter((region) => region.kind === "wheel");
    for (const mark of list.concat(wheels.map((region) => ({ t_s: region.from_s, kind: "wheel" })))) {
      if (!DRAWN.has(mark.kind) || mark.t_s < min || mark.t_s > max) continue;
      const x = Math.round(plot.valToPos(mark.t_s, "x", true));
      const bad = mark.kind === "alarm" || mark.kind === "trip";
      line(ctx, x, box, styled(bad ? "--alarm" : "--ink-2"), [4, 3], 1);
      if (labelled) {
        ctx.fillStyle = styled(bad ? "--alarm" : "--ink");
        const px = devicePixelRatio * scale();
        ctx.fillText(kindOf(mark.kind).sign, x + 3 * px, box.top + box.height - 16 * px);
      }
    }
    if (cursor !== null && cursor !== undefined && cursor >= min && cursor <= max) {
      line(ctx, Math.round(plot.valToPos(cursor, "x", true)), box, styled("--ink"), [], 2);
    }
  });
}

function line(ctx, x, box, colour, dash, width) {
  ctx.strokeStyle = colour;
  ctx.lineWidth = width * devicePixelRatio * scale();
  ctx.setLineDash(dash.map((part) => part * devicePixelRatio));
  ctx.beginPath();
  ctx.moveTo(x, box.top);
  ctx.lineTo(x, box.top + box.height);
  ctx.stroke();
  ctx.setLineDash([]);
}
