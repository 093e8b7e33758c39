// The steps in time: a band of colours, a slider, and the events worth finding again.

import { MODES, MODE_COLORS } from "./vocabulary.js";
import { element, swatch } from "./elements.js";

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

  show(steps) {
    this.steps = steps;
    this.slider.disabled = steps.length < 2;
    this.slider.max = Math.max(steps.length - 1, 0);
    if (this.isLive) this.slider.value = this.slider.max;
    this.live.setAttribute("aria-pressed", String(this.isLive));
    const step = steps[this.shown];
    const words = step ? `Step ${step.step + 1} of ${steps.at(-1).step + 1}, ${MODES[step.mode]}` : "No step yet";
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
    const events = [...step.events];
    if (step.mode !== before?.mode) events.unshift(MODES[step.mode]);
    for (const event of events) {
      const button = element("button", { type: "button" }, `Step ${step.step + 1}`);
      button.addEventListener("click", () => this.go(place));
      this.events.prepend(element("li", {}, button, element("span", {}, event)));
    }
    while (this.events.childElementCount > MOST_EVENTS) this.events.lastElementChild.remove();
  }

  draw() {
    this.band.width = Math.round(this.band.clientWidth * (window.devicePixelRatio || 1));
    const context = this.band.getContext("2d");
    const width = this.band.width / Math.max(this.steps.length, 1);
    this.steps.forEach((step, n) => {
      context.fillStyle = MODE_COLORS[step.mode];
      context.fillRect(n * width, 0, Math.ceil(width), this.band.height);
    });
  }
}
