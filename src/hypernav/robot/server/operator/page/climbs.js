// The stairs that the robot took or tried, told from its steps.

import { floorOf } from "./follower.js";

const SAME_STAIRS_M = 1.0;
const IN_VAIN = "stairs given up";

/** Ends of stairs on a floor: `{ at: [x, y], words }`. Stairs that were taken once lead there. */
export function stairsOn(floor, steps) {
  const marks = [];
  const add = (at, words) => {
    const isHere = (mark) => Math.hypot(mark.at[0] - at[0], mark.at[1] - at[1]) <= SAME_STAIRS_M;
    marks.splice(0, marks.length, ...marks.filter((mark) => !isHere(mark)), { at, words });
  };
  for (const climb of climbs(steps).sort((a, b) => (a.other !== null) - (b.other !== null))) {
    if (climb.floor === floor) add(climb.ends[0], climb.other !== null ? `to floor ${climb.other}` : climb.isInVain ? "no way" : "stairs");
    else if (climb.other === floor) add(climb.ends[1], `to floor ${climb.floor}`);
  }
  return marks;
}

function climbs(steps) {
  const found = [];
  steps.forEach((step, n) => {
    const [before, floor] = [steps[n - 1], floorOf(step)];
    const wasClimbing = before?.mode === "climb";
    if (wasClimbing && floorOf(before) !== floor) found.at(-1).other = floor;
    if (wasClimbing && floorOf(before) === floor) found.at(-1).isInVain ||= step.events.includes(IN_VAIN);
    if (step.mode !== "climb") return;
    if (!wasClimbing || floorOf(before) !== floor) found.push({ floor, other: null, isInVain: false, ends: [step.pose, step.pose] });
    found.at(-1).ends[1] = step.pose;
  });
  return found;
}
