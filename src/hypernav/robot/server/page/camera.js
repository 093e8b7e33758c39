// The camera image with detections.

import { COLORS } from "./vocabulary.js";

/** Draws an image and the detections of its step; returns what it shows in words. */
export function drawCamera(canvas, image, step) {
  canvas.width = image.width;
  canvas.height = image.height;
  const context = canvas.getContext("2d");
  context.drawImage(image, 0, 0);
  const unit = image.width / 320;
  const detections = step?.detections ?? [];
  for (const detection of detections) drawDetection(context, detection, unit);
  const words = describe(detections);
  canvas.setAttribute("aria-label", `Camera image: ${words}`);
  return words;
}

function drawDetection(context, detection, unit) {
  const color = detection.accepted ? COLORS.goal : COLORS.chosen;
  const [left, top, right, bottom] = detection.box;
  context.fillStyle = color;
  context.globalAlpha = 0.4;
  context.beginPath();
  for (const outline of detection.outlines) {
    outline.forEach(([x, y], n) => (n ? context.lineTo(x, y) : context.moveTo(x, y)));
    context.closePath();
  }
  context.fill("evenodd");
  context.globalAlpha = 1;
  context.strokeStyle = color;
  context.lineWidth = 2 * unit;
  context.setLineDash(detection.accepted ? [] : [5 * unit, 4 * unit]);
  context.strokeRect(left, top, right - left, bottom - top);
  context.setLineDash([]);
  const label = detection.score < 1 ? `${detection.label} ${Math.round(100 * detection.score)} %` : detection.label;
  context.font = `600 ${11 * unit}px system-ui, sans-serif`;
  const width = context.measureText(label).width + 8 * unit;
  const x = Math.max(Math.min(left, context.canvas.width - width), 0);
  const y = top < 16 * unit ? Math.min(bottom, context.canvas.height - 16 * unit) : top - 16 * unit;
  context.fillRect(x, y, width, 16 * unit);
  context.fillStyle = detection.accepted ? COLORS.paper : COLORS.ink;
  context.fillText(label, x + 4 * unit, y + 12 * unit);
}

function describe(detections) {
  if (!detections.length) return "the goal is not in view.";
  return detections
    .map((one) => (one.accepted ? `sees “${one.label}”` : `“${one.label}” not accepted: ${one.reason || "no reason given"}`))
    .join("; ") + ".";
}
