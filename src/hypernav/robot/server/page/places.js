// Places on the map: a click, or the crosshair and Enter, closes one to the robot or opens it again.

import { element, metres } from "./elements.js";
import { post, request } from "./server.js";

const STILL_PX = 6; // a press that moves farther is a drag of the map
const STEP_M = 0.25;

/** The menu of a place. Calls `onChange()` when what is drawn has changed. */
export class Places {
  areas = []; // closed ones of the search
  spot = null; // chosen place {x, y}, with the radius of the area that would be closed

  constructor(canvas, menu, lens, onChange) {
    Object.assign(this, { canvas, menu, lens, onChange });
    canvas.addEventListener("pointerdown", ({ clientX, clientY }) => { this.pressed = [clientX, clientY]; });
    canvas.addEventListener("click", (event) => {
      if (this.pressed && Math.hypot(event.clientX - this.pressed[0], event.clientY - this.pressed[1]) > STILL_PX) return;
      this.choose(this.placeOf(this.lens.off(event)));
      this.open();
    });
    canvas.addEventListener("keydown", (event) => this.key(event));
    menu.addEventListener("keydown", ({ key }) => { if (key === "Escape") this.close(); });
  }

  /** What is drawn: the closed places of a floor, and the chosen place. */
  shown(floor) {
    if (floor !== this.floor) {
      this.floor = floor;
      this.spot = null;
      this.menu.hidden = true;
    }
    return { areas: this.areas.filter((one) => one.floor === floor), spot: this.spot };
  }

  /** Follows a search under way; a null path allows no choice. */
  follow(path) {
    if (path !== this.path) {
      Object.assign(this, { path, areas: [] });
      this.close();
    }
    if (!path) return;
    request(`${path}/no-entry`).then((answer) => answer.json()).then((areas) => {
      if (path !== this.path || JSON.stringify(areas) === JSON.stringify(this.areas)) return;
      this.areas = areas;
      this.onChange();
    }).catch(() => {}); // the connection line says so
  }

  placeOf([right, up]) {
    const [x, y] = this.lens.middle ?? [0, 0];
    return [x + right, y + up];
  }

  choose([x, y]) {
    if (!this.path || !this.lens.middle) return;
    this.spot = { x, y, radius_m: this.spot?.radius_m ?? 0.5 };
    this.onChange();
  }

  key(event) {
    const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    if (event.key === "Escape") this.close();
    else if (event.key === "Enter") {
      if (!this.spot) this.choose(this.placeOf([0, 0]));
      this.open();
    } else if (event.key in moves) {
      const [right, up] = moves[event.key];
      const from = this.spot ? [this.spot.x, this.spot.y] : this.placeOf([0, 0]);
      this.choose([from[0] + STEP_M * right, from[1] + STEP_M * up]);
    } else return;
    event.preventDefault();
  }

  close() {
    const hadFocus = this.menu.contains(document.activeElement);
    this.menu.hidden = true;
    this.spot = null;
    if (hadFocus) this.canvas.focus();
    this.onChange();
  }

  open() {
    if (!this.spot) return;
    const { x, y } = this.spot;
    const inside = this.areas.find((one) => one.floor === this.floor && Math.hypot(one.x - x, one.y - y) <= one.radius_m);
    const words = element("p", { role: "status" }, `Place at ${metres(x)}, ${metres(y)}`);
    const act = inside ? element("button", { type: "button" }, "Allow again") : element("button", { type: "button" }, "Do not enter");
    const send = inside
      ? () => request(`${this.path}/no-entry/${inside.number}`, { method: "DELETE" })
      : () => post(`${this.path}/no-entry`, { ...this.spot, floor: this.floor });
    act.addEventListener("click", async () => {
      act.disabled = true;
      try {
        await send();
        this.close();
        this.follow(this.path);
      } catch (error) {
        words.textContent = `That did not work: ${error.message}`;
        act.disabled = false;
      }
    });
    const cancel = element("button", { type: "button" }, "Cancel");
    cancel.addEventListener("click", () => this.close());
    this.menu.replaceChildren(words, ...(inside ? [] : [this.radius()]), act, cancel);
    this.menu.hidden = false;
    act.focus();
  }

  radius() {
    const said = () => `Radius ${this.spot.radius_m.toFixed(1)} m`;
    const slider = element("input", { type: "range", min: "0.2", max: "3", step: "0.1", value: String(this.spot.radius_m) });
    const text = element("span", {}, said());
    slider.addEventListener("input", () => {
      this.spot.radius_m = Number(slider.value);
      text.textContent = said();
      this.onChange();
    });
    return element("label", {}, text, slider);
  }
}
