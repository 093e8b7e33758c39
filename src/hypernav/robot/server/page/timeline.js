// The steps in time: a band of colours, a slider, and the events worth finding again.

import { element, swatch } from "./elements.js";
import { floorOf, namesFloors, whereIs } from "./follower.js";
import { COLORS, MODES, MODE_COLORS } from "./vocabulary.js";

const MOST_EVENTS = 200;

/** Chooses the step that is shown. Calls `onMove()` when somebody moves it. */
export class Timeline {
  isLive = true;
  steps = [];
  listed = 0;

  constructor(onMove) {
    this.onMove = onMove;
    this.slider = document.getElementById("slider");
    this.live = document.getElementById("live");
    this.band = document.getElementById("band");
    this.floorBand = document.getElementById("floor-band");
    this.events = document.getElementById("events");
    this.slider.addEventListener("input", () => this.go(Number(this.slider.value)));
    this.live.addEventListener("click", () => this.go(this.steps.length - 1));
    const modes = Object.entries(MODES).map(([mode, words]) => element("li", {}, swatch(MODE_COLORS[mode]), words));
    document.getElementById("modes").replaceChildren(...modes);
  }

  /** Number of the step to show; -1 if there is none. */
  get shown() {
    return this.isLive ? this.steps.length - 1 : Math.min(Number(this.slider.value), this.steps.length - 1);
  }

  /** Starts again with another search. */
  reset() {
    this.isLive = true;
    this.steps = [];
    this.listed = 0;
    this.events.replaceChildren();
  }

  /** Shows the steps; the floors are named as in `floorWords`. */
  show(steps, floorWords) {
    this.steps = steps;
    this.floorWords = floorWords;
    this.slider.disabled = steps.length < 2;
    this.slider.max = Math.max(steps.length - 1, 0);
    if (this.isLive) this.slider.value = this.slider.max;
    this.live.setAttribute("aria-pressed", String(this.isLive));
    const step = steps[this.shown];
    const words = step ? `Step ${step.step + 1} of ${steps.at(-1).step + 1}, ${this.doing(this.shown)}` : "No step yet";
    this.slider.setAttribute("aria-valuetext", words);
    for (; this.listed < steps.length; this.listed += 1) this.list(this.listed);
    this.draw();
  }

  go(place) {
    this.isLive = place >= this.steps.length - 1;
    this.slider.value = place;
    this.onMove();
  }

  list(place) {
    const step = this.steps[place], before = this.steps[place - 1];
    if (step.mode !== before?.mode) {
      const arrives = before && floorOf(step) !== floorOf(before);
      const words = this.doing(place, arrives ? (floor) => this.wordsOf(floor).replace("F", "f") : undefined);
      this.addEvent(place, swatch(MODE_COLORS[step.mode]), words);
    }
    for (const event of step.events) this.addEvent(place, event);
    while (this.events.childElementCount > MOST_EVENTS) this.events.lastElementChild.remove();
  }

  addEvent(place, ...words) {
    const button = element("button", { type: "button" }, `Step ${this.steps[place].step + 1}`);
    button.addEventListener("click", () => this.go(place));
    this.events.prepend(element("li", {}, button, element("span", {}, ...words)));
  }

  /** What the robot does, and where if there is more than one floor to tell apart. */
  doing(place, nameOf) {
    const { mode } = this.steps[place];
    if (!namesFloors(this.steps)) return MODES[mode];
    const where = whereIs(this.steps, place, nameOf);
    return mode === "climb" ? where.replace("on", "On") : `${MODES[mode]} ${where}`;
  }

  wordsOf(floor) {
    return this.floorWords[floor] ?? `Floor ${floor}`;
  }

  draw() {
    this.band.width = Math.round(this.band.clientWidth * (window.devicePixelRatio || 1));
    const context = this.band.getContext("2d");
    const width = this.band.width / Math.max(this.steps.length, 1);
    this.steps.forEach((step, n) => {
      context.fillStyle = MODE_COLORS[step.mode];
      context.fillRect(n * width, 0, Math.ceil(width), this.band.height);
    });
    this.floorBand.hidden = !namesFloors(this.steps);
    if (!this.floorBand.hidden) this.drawFloors();
  }

  /** The floor on which the robot was at each step, named as far as there is room; brown on stairs. */
  drawFloors() {
    const ratio = window.devicePixelRatio || 1;
    this.floorBand.width = Math.round(this.floorBand.clientWidth * ratio);
    this.floorBand.height = Math.round(this.floorBand.clientHeight * ratio);
    const { width, height } = this.floorBand;
    const context = this.floorBand.getContext("2d");
    context.font = `${12 * ratio}px system-ui, sans-serif`;
    context.textBaseline = "middle";
    for (const { first, count, floor, climbs } of this.stays()) {
      const left = (first * width) / this.steps.length, right = ((first + count) * width) / this.steps.length;
      context.fillStyle = climbs ? COLORS.stairs : COLORS.faint;
      context.fillRect(left, 0, right - left, height);
      const names = [this.wordsOf(floor), `Floor ${floor}`, String(floor)];
      const name = names.find((one) => context.measureText(one).width + 10 * ratio < right - left);
      context.fillStyle = COLORS.ink;
      if (name && !climbs) context.fillText(name, left + 5 * ratio, height / 2);
    }
  }

  /** Runs of steps on one floor, or on stairs from it. */
  stays() {
    const found = [];
    this.steps.forEach((step, first) => {
      const [floor, climbs] = [floorOf(step), step.mode === "climb"];
      const last = found.at(-1);
      if (last?.floor === floor && last.climbs === climbs) last.count += 1;
      else found.push({ first, count: 1, floor, climbs });
    });
    return found;
  }
}
