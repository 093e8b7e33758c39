// The map from above, with the robot and its plan.

import { floorOf } from "./follower.js";
import { COLORS } from "./vocabulary.js";

const MARGIN_M = 0.6;
const LEAST_M = 4;

/** Draws the map of a floor and everything on it at the shown step, sharp on any screen. */
export function drawMap(canvas, map, steps, stairs, shown, floor, { lens, things, places }) {
  const ratio = window.devicePixelRatio || 1;
  canvas.width = Math.round(canvas.clientWidth * ratio);
  canvas.height = Math.round(canvas.clientHeight * ratio);
  const context = canvas.getContext("2d");
  context.fillStyle = COLORS.unknown;
  context.fillRect(0, 0, canvas.width, canvas.height);
  if (!map || shown < 0) return;
  const view = fit(canvas, map.extent, lens);
  lens.scale = view.scale / ratio;
  lens.middle = view.middle;
  const draw = new Painter(context, view, ratio);
  const step = steps[shown];
  const walked = steps.slice(0, shown + 1);
  const isHere = floorOf(step) === floor;
  draw.cells(map);
  draw.things(things.filter((one) => one.thing.floor === floor && one.outline), lens.zoom);
  if (isHere) draw.area(step.goal_area);
  if (isHere) draw.blocks(steps, shown);
  for (const walk of walksOn(floor, walked)) draw.line(walk, COLORS.trajectory_new, 2);
  const changed = Object.keys(stairs).findLast((since) => since <= shown);
  draw.stairs(stairs[changed]?.[floor] ?? []);
  if (isHere) {
    draw.line(step.path, COLORS.path, 2.5, [6, 4]);
    if (step.destination) draw.destination(step.destination);
    draw.robot(step.pose);
  }
  for (const area of places.areas) draw.closed(area, 0.35);
  if (places.going) draw.flag(places.going);
  if (places.spot) draw.spot(places.spot);
  draw.scale();
}

/** The poses on a floor, in a row each time that the robot was there. */
function walksOn(floor, steps) {
  const walks = [[]];
  for (const step of steps) {
    if (floorOf(step) === floor) walks.at(-1).push(step.pose);
    else if (walks.at(-1).length) walks.push([]);
  }
  return walks;
}

/** Metres to pixels: `at(x, y)` and `scale` pixels a metre. */
function fit(canvas, extent, lens) {
  const { rows, columns, resolution_m: size, origin } = extent;
  const width = Math.max(columns * size + 2 * MARGIN_M, LEAST_M);
  const height = Math.max(rows * size + 2 * MARGIN_M, LEAST_M);
  const scale = lens.zoom * Math.min(canvas.width / width, canvas.height / height);
  const middle = [origin[0] + (columns * size) / 2 + lens.aside[0], origin[1] + (rows * size) / 2 + lens.aside[1]];
  const at = (x, y) => [canvas.width / 2 + (x - middle[0]) * scale, canvas.height / 2 - (y - middle[1]) * scale];
  return { at, scale, middle };
}

class Painter {
  constructor(context, view, ratio) {
    this.context = context;
    this.view = view;
    this.ratio = ratio;
  }

  cells({ image, extent }) {
    const [left, bottom] = this.view.at(...extent.origin);
    const pixel = this.view.scale * extent.resolution_m;
    this.context.imageSmoothingEnabled = false;
    this.context.drawImage(image, left, bottom - extent.rows * pixel, extent.columns * pixel, extent.rows * pixel);
  }

  /** The things of the memory; nearer, where there is room, with their names. */
  things(things, zoom) {
    const { context, ratio } = this;
    context.strokeStyle = COLORS.ink;
    context.lineWidth = ratio;
    context.font = `600 ${11 * ratio}px system-ui, sans-serif`;
    context.textAlign = "center";
    for (const { outline: [low, high], label } of things) {
      const [left, bottom] = this.view.at(...low);
      const [right, top] = this.view.at(...high);
      context.strokeRect(left, top, right - left, bottom - top);
      if (zoom > 1.4) this.text(label, (left + right) / 2, (top + bottom) / 2 + 4 * ratio);
    }
  }

  area(polygons) {
    const { context } = this;
    context.beginPath();
    for (const polygon of polygons) {
      polygon.forEach(([x, y], n) => (n ? context.lineTo(...this.view.at(x, y)) : context.moveTo(...this.view.at(x, y))));
      context.closePath();
    }
    context.fillStyle = COLORS.goal;
    context.globalAlpha = 0.45;
    context.fill("evenodd");
    context.globalAlpha = 1;
  }

  /** The blocks of the last question about the map, as long as the robot goes to the chosen one. */
  blocks(steps, shown) {
    let asked = shown;
    while (asked >= 0 && !steps[asked].blocks.length) asked -= 1;
    if (asked < 0 || steps[shown].mode !== "explore" || floorOf(steps[asked]) !== floorOf(steps[shown])) return;
    const exchange = steps[asked].exchanges.findLast((one) => one.chosen !== null);
    const { context, ratio } = this;
    for (const block of steps[asked].blocks) {
      const side = block.size_m * this.view.scale;
      const [left, bottom] = this.view.at(block.x_min, block.y_min);
      const isChosen = block.number === exchange?.chosen;
      if (isChosen) {
        context.globalAlpha = 0.35;
        context.fillStyle = COLORS.chosen;
        context.fillRect(left, bottom - side, side, side);
        context.globalAlpha = 1;
      }
      context.strokeStyle = isChosen ? COLORS.chosen : COLORS.block;
      context.lineWidth = (isChosen ? 2.5 : 1) * ratio;
      context.strokeRect(left, bottom - side, side, side);
      const size = Math.min(Math.max(side / 3, 9 * ratio), 16 * ratio);
      context.font = `600 ${size}px system-ui, sans-serif`;
      context.textAlign = "left";
      this.text(String(block.number), left + 3 * ratio, bottom - side + size);
    }
  }

  text(words, x, y) {
    const { context, ratio } = this;
    context.strokeStyle = COLORS.free;
    context.lineWidth = 3 * ratio;
    context.strokeText(words, x, y);
    context.fillStyle = COLORS.ink;
    context.fillText(words, x, y);
  }

  line(points, color, width, dash = []) {
    const { context, ratio } = this;
    context.beginPath();
    for (const [x, y] of points) context.lineTo(...this.view.at(x, y));
    context.strokeStyle = color;
    context.lineWidth = width * ratio;
    context.lineJoin = context.lineCap = "round";
    context.setLineDash(dash.map((length) => length * ratio));
    context.stroke();
    context.setLineDash([]);
  }

  /** The ends of stairs, each with where it leads beside it; no words cover others. */
  stairs(marks) {
    const { context, ratio } = this;
    const half = 7 * ratio, row = 14 * ratio, gap = half + 4 * ratio;
    const at = marks.map(({ position: [x, y] }) => this.view.at(x, y));
    const taken = at.map(([u, v]) => ({ left: u - half, right: u + half, v }));
    const isFree = (box) => taken.every((other) => box.right <= other.left || other.right <= box.left || Math.abs(box.v - other.v) >= row);
    context.font = `600 ${12 * ratio}px system-ui, sans-serif`;
    context.textAlign = "left";
    marks.forEach(({ words }, n) => {
      const [u, v] = at[n];
      context.fillStyle = COLORS.stairs;
      for (const tread of [0, 1, 2]) context.fillRect(u - half + 0.67 * half * tread, v + half * (0.33 - 0.67 * tread), half * (2 - 0.67 * tread), 0.67 * half);
      const width = context.measureText(words).width;
      const options = [0, -1, 1, -2, 2].flatMap((rows) => [u + gap, u - gap - width].map((left) => ({ left, right: left + width, v: v + rows * row })));
      const box = options.find(isFree) ?? options[0];
      taken.push(box);
      this.text(words, box.left, box.v + 0.3 * row);
    });
  }

  /** A place that the robot is not to enter. */
  closed({ x, y, radius_m: radius }, alpha) {
    const { context, ratio } = this;
    context.beginPath();
    context.arc(...this.view.at(x, y), radius * this.view.scale, 0, 2 * Math.PI);
    context.fillStyle = context.strokeStyle = COLORS.failure;
    context.globalAlpha = alpha;
    context.fill();
    context.globalAlpha = 1;
    context.lineWidth = 2 * ratio;
    context.stroke();
  }

  /** The chosen place: a crosshair, and the area that would be closed. */
  spot(spot) {
    this.closed(spot, 0.15);
    const half = 9 * this.ratio / this.view.scale;
    this.line([[spot.x - half, spot.y], [spot.x + half, spot.y]], COLORS.ink, 2);
    this.line([[spot.x, spot.y - half], [spot.x, spot.y + half]], COLORS.ink, 2);
  }

  /** The place that the robot was sent to. */
  flag({ x, y }) {
    const [u, v] = this.view.at(x, y);
    const { context, ratio } = this;
    context.fillStyle = COLORS.path;
    context.fillRect(u - ratio, v - 26 * ratio, 2 * ratio, 26 * ratio);
    context.beginPath();
    for (const [right, up] of [[0, 26], [16, 20], [0, 14]]) context.lineTo(u + right * ratio, v - up * ratio);
    context.fill();
  }

  destination([x, y]) {
    const [u, v] = this.view.at(x, y);
    const { context, ratio } = this;
    context.strokeStyle = COLORS.path;
    context.lineWidth = 2.5 * ratio;
    context.beginPath();
    context.arc(u, v, 7 * ratio, 0, 2 * Math.PI);
    context.moveTo(u - 11 * ratio, v);
    context.lineTo(u + 11 * ratio, v);
    context.moveTo(u, v - 11 * ratio);
    context.lineTo(u, v + 11 * ratio);
    context.stroke();
  }

  robot([x, y, yaw]) {
    const { context, ratio } = this;
    const size = Math.max(0.3 * this.view.scale, 11 * ratio);
    context.save();
    context.translate(...this.view.at(x, y));
    context.rotate(-yaw);
    context.beginPath();
    for (const [ahead, left] of [[1, 0], [-0.76, 0.64], [-0.38, 0], [-0.76, -0.64]]) context.lineTo(ahead * size, -left * size);
    context.closePath();
    context.fillStyle = COLORS.robot;
    context.strokeStyle = COLORS.paper;
    context.lineWidth = 3 * ratio;
    context.stroke();
    context.fill();
    context.restore();
  }

  scale() {
    const { context, ratio } = this;
    const metres = [0.5, 1, 2, 5, 10, 20, 50, 100].find((one) => one * this.view.scale > 50 * ratio) ?? 100;
    const y = context.canvas.height - 10 * ratio;
    const right = context.canvas.width - 12 * ratio;
    const left = right - metres * this.view.scale;
    context.strokeStyle = COLORS.ink;
    context.lineWidth = 3 * ratio;
    context.beginPath();
    context.moveTo(left, y);
    context.lineTo(right, y);
    context.stroke();
    context.font = `600 ${11 * ratio}px system-ui, sans-serif`;
    context.textAlign = "center";
    this.text(`${metres} m`, (left + right) / 2, y - 5 * ratio);
  }
}
