// Places on the map: a click, or the crosshair and Enter, chooses one to send the robot to, to close
// to it, or to open again.

import { element, metres } from "./elements.js";
import { getJson, post, request } from "./server.js";

const STILL_PX = 6; // a press that moves farther is a drag of the map
const STEP_M = 0.25;
const ON_ITS_WAY = "on its way";
const BESIDE_M = 0.5; // from here on the distance is said

/** What has come of the place that the robot was sent to. */
function goingWords({ x, y, state, away_m: away }) {
  const place = `the chosen place at ${metres(x)}, ${metres(y)}`;
  const beside = away > BESIDE_M ? `, as near as it can drive: ${metres(away)} m from it` : "";
  return {
    [ON_ITS_WAY]: `The robot is on its way to ${place}. If it sees what it looks for, it goes there first.`,
    reached: `The robot has reached ${place}${beside}. It searches on by itself.`,
    "no path over what is known": `The robot knows no path to ${place}. It searches on by itself.`,
    "no progress": `The robot came no nearer to ${place} and has given it up. It searches on by itself.`,
  }[state];
}

/** The menu of a place, and what has come of the one to go to. Calls `onChange()` when what is drawn has changed. */
export class Places {
  areas = []; // closed ones of the search
  going = null; // the place that the robot was sent to last
  spot = null; // chosen place {x, y}, with the radius of the area that would be closed

  constructor(canvas, menu, goingBox, lens, onChange) {
    Object.assign(this, { canvas, menu, goingBox, lens, onChange });
    canvas.addEventListener("pointerdown", ({ clientX, clientY }) => { this.pressed = [clientX, clientY]; });
    canvas.addEventListener("click", (event) => {
      if (this.pressed && Math.hypot(event.clientX - this.pressed[0], event.clientY - this.pressed[1]) > STILL_PX) return;
      this.choose(this.placeOf(this.lens.off(event)));
      this.open();
    });
    canvas.addEventListener("keydown", (event) => this.key(event));
    menu.addEventListener("keydown", ({ key }) => { if (key === "Escape") this.close(); });
  }

  /** What is drawn: the closed places of a floor, the one that the robot goes to, and the chosen place. */
  shown(floor, floorOfRobot) {
    this.floorOfRobot = floorOfRobot;
    if (floor !== this.floor) {
      this.floor = floor;
      this.spot = null;
      this.menu.hidden = true;
    }
    const going = this.going?.state === ON_ITS_WAY && this.going.floor === floor ? this.going : null;
    return { areas: this.areas.filter((one) => one.floor === floor), going, spot: this.spot };
  }

  /** Follows a search under way; a null path allows no choice. */
  follow(path) {
    if (path !== this.path) {
      Object.assign(this, { path, areas: [], going: null });
      this.showGoing();
      this.close();
    }
    if (!path) return;
    Promise.all([getJson(`${path}/no-entry`), getJson(`${path}/go-to`)]).then(([areas, going]) => {
      if (path !== this.path || JSON.stringify([areas, going]) === JSON.stringify([this.areas, this.going])) return;
      Object.assign(this, { areas, going });
      this.showGoing();
      this.onChange();
    }).catch(() => {}); // the connection line says so
  }

  showGoing() {
    const [words, cancel] = this.goingBox.children;
    this.goingBox.hidden = !this.going;
    words.textContent = this.going ? goingWords(this.going) : "";
    cancel.hidden = this.going?.state !== ON_ITS_WAY;
    cancel.disabled = false;
    cancel.onclick = () => this.send(cancel, words, () => request(`${this.path}/go-to`, { method: "DELETE" }));
  }

  /** Sends what a button says; where that fails, the words say why. */
  async send(button, words, request) {
    button.disabled = true;
    try {
      await request();
      this.close();
      this.follow(this.path);
    } catch (error) {
      words.textContent = `That did not work: ${error.message}`;
      button.disabled = false;
    }
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
    const isOnFloor = this.floor === this.floorOfRobot;
    const elsewhere = isOnFloor ? "" : ". The robot is on another floor, and can be sent to places on its own only.";
    const words = element("p", { role: "status" }, `Chosen place: ${metres(x)}, ${metres(y)}${elsewhere}`);
    const button = (name, request) => {
      const made = element("button", { type: "button" }, name);
      made.addEventListener("click", () => (request ? this.send(made, words, request) : this.close()));
      return made;
    };
    const body = { x, y, floor: this.floor };
    const parts = inside
      ? [button("Allow again", () => request(`${this.path}/no-entry/${inside.number}`, { method: "DELETE" }))]
      : [
        ...(isOnFloor ? [button("Go there", () => request(`${this.path}/go-to`, { method: "PUT", body }))] : []),
        this.radius(),
        button("Do not enter", () => post(`${this.path}/no-entry`, { ...body, radius_m: this.spot.radius_m })),
      ];
    this.menu.replaceChildren(words, ...parts, button("Cancel"));
    this.menu.hidden = false;
    this.menu.querySelector("button").focus();
  }

  radius() {
    const said = () => `Area not to enter: radius ${this.spot.radius_m.toFixed(1)} m`;
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
