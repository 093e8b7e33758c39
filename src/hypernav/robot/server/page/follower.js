// One search, followed from its first step to its end, across reconnects and restarts of the server.

import { Refused, getJson, parse, pause, request } from "./server.js";

const WAIT_S = 10;
const SHORTEST_ROUND_MS = 120;
const RETRY_MS = 1000;

/** Number of the floor of a step; it has none as long as only one floor is known. */
export const floorOf = (step) => step.floor ?? 1;

/** Whether there is more than one floor to tell apart: another is known, or the robot is on stairs. */
export const namesFloors = (steps) => steps.some((step) => step.floor || step.mode === "climb");

/** Where the robot is at a step: "on floor 2", "on the stairs from floor 2 to floor 3" if it came there. */
export function whereIs(steps, place, nameOf = (floor) => `floor ${floor}`) {
  const floor = floorOf(steps[place]);
  if (steps[place].mode !== "climb") return `on ${nameOf(floor)}`;
  const after = steps.slice(place).find((step) => step.mode !== "climb" || floorOf(step) !== floor);
  const to = after && floorOf(after) !== floor ? ` to ${nameOf(floorOf(after))}` : "";
  return `on the stairs from ${nameOf(floor)}${to}`;
}

/** What says where the robot is: a floor as far as it is known, or stairs from one. */
const spot = (step) => (step ? `${step.floor ?? ""}${step.mode === "climb" ? " climb" : ""}` : "");

/** What is known of one search. Calls `onChange(follower)` after every change. */
export class Follower {
  status = null;
  steps = [];
  stairs = {}; // the ends of stairs on every floor, from each step on that changed them
  floorWords = {}; // the floors in words, with their heights
  things = []; // what the memory knew, where the map of the search is that of the memory
  hasMoved = false; // whether the robot came to stairs or to a floor since these were fetched
  maps = new Map(); // the last map of each floor
  unmapped = new Set(); // floors left before this page was opened of which the server has no map

  constructor(id, onChange) {
    this.path = `v1/searches/${id}`;
    this.id = id;
    this.onChange = onChange;
    this.ended = new AbortController();
    this.run();
  }

  close() {
    this.ended.abort();
  }

  async run() {
    let version = -1;
    while (!this.ended.signal.aborted) {
      const began = performance.now();
      try {
        const query = `?after=${version}&wait_s=${version < 0 ? 0 : WAIT_S}`;
        const status = await this.get(query, { waitMs: WAIT_S * 1000 });
        await this.update(status);
        version = status.version;
        // The search is over.
        if (status.state === "ended") return;
      } catch (error) {
        if (this.ended.signal.aborted) return;
        if (error instanceof Refused && error.status === 404) return;
        version = -1; // a restarted server counts from 0
        await pause(RETRY_MS);
      }
      await pause(Math.max(SHORTEST_ROUND_MS - (performance.now() - began), 0));
    }
  }

  async update(status) {
    const isNew = !this.status || status.next_sequence !== this.status.next_sequence
      || status.last?.sequence !== this.status.last?.sequence || !status.map !== !this.maps.size;
    if (isNew && status.next_sequence > 0) {
      const lines = await (await this.request(`/trace?since=${(this.steps.at(-1)?.step ?? -1) + 1}`)).text();
      const known = this.steps.length;
      for (const line of lines.split("\n")) if (line) this.steps.push(parse(line));
      // Stairs and floors change only where the robot comes to one or leaves it.
      this.hasMoved ||= this.steps.slice(known).some((step, k) => spot(step) !== spot(this.steps[known + k - 1]));
      if (this.hasMoved) [this.stairs, this.floorWords] = await Promise.all([this.get("/stairs"), this.get("/floors/words")]);
      this.hasMoved = false;
      if (status.map) { // a server that was started again has no map until it has caught up
        await this.updateMap(status.map);
        await this.fetchOtherFloors();
      }
    }
    if (!this.status || JSON.stringify(status.start) !== JSON.stringify(this.status.start)) {
      this.things = await getJson(`v1/things/of/${this.id}`, { signal: this.ended.signal }).catch(() => []);
    }
    this.status = { ...status, receivedMs: performance.now() };
    this.onChange(this);
  }

  async updateMap(extent) {
    const image = await createImageBitmap(await (await this.request("/map.png")).blob());
    // The map may have grown since; then the next round has both.
    if (image.width === extent.columns && image.height === extent.rows) this.maps.set(floorOf(this.steps.at(-1)), { image, extent });
  }

  /** The maps of floors that the robot left before this page was opened. */
  async fetchOtherFloors() {
    const here = floorOf(this.steps.at(-1));
    const floors = new Set(this.steps.map(floorOf));
    const missing = [...floors].filter((floor) => floor !== here && !this.maps.has(floor) && !this.unmapped.has(floor));
    if (!missing.length) return;
    const extents = await this.get("/floors");
    for (const floor of missing) {
      if (!extents[floor]) {
        this.unmapped.add(floor);
        continue;
      }
      const image = await createImageBitmap(await (await this.request(`/map.png?floor=${floor}`)).blob());
      this.maps.set(floor, { image, extent: extents[floor] });
    }
  }

  /** Image of an observation. */
  async image(sequence) {
    return createImageBitmap(await (await this.request(`/image?sequence=${sequence}`)).blob());
  }

  request(path, options) {
    return request(this.path + path, { signal: this.ended.signal, ...options });
  }

  get(path, options) {
    return getJson(this.path + path, { signal: this.ended.signal, ...options });
  }
}
