// The operator's page: follows one search, lists all, and keeps the rest up to date.

import { drawCamera } from "./camera.js";
import { GoalBox, Memory, armStop, armToken } from "./controls.js";
import { element, metres, swatch } from "./elements.js";
import { Follower, floorOf, namesFloors, whereIs } from "./follower.js";
import { Lens } from "./lens.js";
import { drawMap } from "./map.js";
import { Places } from "./places.js";
import { connection, getJson, hasToken, pause, post } from "./server.js";
import { Timeline } from "./timeline.js";
import { ACTIONS, COLORS, MODES, QUESTIONS } from "./vocabulary.js";

const POLL_MS = 1000;
const SILENT_S = 10;
const CONNECTION = {
  connecting: "Connecting …",
  on: "Connected",
  off: "No connection to the server. Trying again … A robot led by RobotClient stands still without it.",
  token: "The server asks for its token.",
};
const STATES = { resuming: "The server was started again and repeats what it has seen", deciding: "deciding …" };
const LEGEND = [
  ["robot", COLORS.robot, "M15 8 2 14l3-6-3-6z"],
  ["path so far", COLORS.trajectory_new, "M0 6h16v4H0z"],
  ["plan", COLORS.path, "M0 6h6v4H0zM9 6h6v4H9z"],
  ["destination", COLORS.path, "M7 0h2v7h7v2H9v7H7V9H0V7h7z"],
  ["chosen block", COLORS.chosen],
  ["goal area", COLORS.goal],
  ["stairs taken or tried", COLORS.stairs],
  ["obstacle", COLORS.occupied],
  ["closed to the robot", COLORS.failure, "M8 1a7 7 0 1 0 .01 0z"],
  ["place to go to", COLORS.path, "M3 0h2v16H3zM5 1l9 4-9 4z"],
  ["remembered thing", COLORS.ink, "M1 1h14v14H1zM3 3v10h10V3z"],
  ["unknown", COLORS.unknown],
];

const byId = (id) => document.getElementById(id);
const timeline = new Timeline(show);
const lens = new Lens(byId("map"), document.querySelectorAll("[data-zoom]"), show);
const places = new Places(byId("map"), byId("place"), byId("going"), lens, show);
let follower = null;
let floorOfRobot = null;
let floorChosen = null; // by hand, until the robot goes to another floor
let isChosen = false; // by hand, so that a new search doesn't take the page away

function follow(id) {
  follower?.close();
  timeline.reset();
  floorChosen = null;
  imageShown = null;
  lens.nearer(0);
  follower = new Follower(id, () => {
    const { status } = follower;
    const isOurs = !status.ending && status.silent_s !== null; // a server's, under way
    places.follow(isOurs ? `v1/searches/${id}` : null);
    show();
  });
}

function show() {
  const { status, steps, stairs, maps, floorWords } = follower ?? { status: null };
  if (!status) return;
  timeline.show(steps, floorWords);
  const step = steps[timeline.shown];
  const word = status.ending ?? (status.state === "resuming" ? "resuming" : "searching");
  document.title = `${status.goal}: ${word} · hypernav`;
  byId("eyebrow").textContent = `Search of ${time(status.opened_s)}`;
  byId("headline").textContent = headline(status);
  byId("reason").textContent = reason(status, step);
  showPause(status);
  byId("start").hidden = !status.start;
  byId("start").textContent = status.start ? startWords(status.start) : "";
  byId("doubts").hidden = !status.doubts.length;
  byId("doubts").textContent = status.doubts.length ? `Check what the robot sends: ${status.doubts.join(" Also: ")}` : "";
  byId("step").textContent = step ? `${step.step + 1} of ${steps.at(-1).step + 1}` : "–";
  byId("driven").textContent = step ? `${driven(steps, timeline.shown).toFixed(1)} m` : "–";
  byId("flat").hidden = !namesFloors(steps);
  byId("action").textContent = next(status, step);
  document.body.dataset.silent = String(isSilent(status));
  byId("words").textContent = status.words.replace("detector ", "").replace(", reasoner ", " · ");
  if (step && floorOf(step) !== floorOfRobot) floorChosen = null;
  floorOfRobot = step ? floorOf(step) : null;
  const floor = floorChosen ?? floorOfRobot;
  const map = step && maps.get(floor);
  drawMap(byId("map"), map, steps, stairs, timeline.shown, floor, { lens, things: follower.things, places: places.shown(floor, floorOfRobot) });
  showFloor(steps, floorWords, floor);
  if (step) {
    byId("map").setAttribute("aria-label", mapWords(map, step, floor));
    showCamera(follower, step);
  }
  showQuestion(steps.slice(0, timeline.shown + 1));
}

/** A search in this program's own window has no robot that could wait, and its status no silence. */
function showPause(status) {
  const button = byId("pause");
  button.hidden = Boolean(status.ending) || status.silent_s === null;
  button.dataset.does = status.detail ? "resume" : "pause";
  button.textContent = status.detail ? "Resume" : "Pause";
}

async function pauseOrResume() {
  const button = byId("pause");
  button.disabled = true;
  try {
    await post(`v1/searches/${follower.id}/${button.dataset.does}`, {});
  } catch (error) {
    byId("reason").textContent = `That did not work: ${error.message}`;
  } finally {
    button.disabled = false;
  }
}

/** What the robot does next; once the search is over it stands, whatever was decided last. */
function next(status, step) {
  if (timeline.isLive && status.ending) return ACTIONS[0];
  return step && step.action !== null ? ACTIONS[step.action] : "–";
}

/** Seconds since the robot's last message; the status is a moment old. */
const silentS = (status) => status.silent_s + (performance.now() - (status.receivedMs ?? performance.now())) / 1000;
const isSilent = (status) => status.state === "waiting" && status.silent_s !== null && silentS(status) > SILENT_S;
const span = (seconds) => (seconds < 60 ? `${Math.floor(seconds)} s` : `${Math.floor(seconds / 60)} min`);

function headline(status) {
  const goal = `“${status.goal}”`;
  const ends = {
    found: `Found ${goal}`, "gave up": `Gave up looking for ${goal}`, stopped: `Stopped, looking for ${goal}`,
    closed: `Closed, looking for ${goal}`, failed: `Failed, looking for ${goal}`,
    "model unavailable": `Stopped: the model did not answer`, "robot failed": `The robot failed, looking for ${goal}`,
  };
  return status.ending ? ends[status.ending] : `Looking for ${goal}`;
}

function reason(status, step) {
  if (!timeline.isLive && step) return `${timeline.doing(timeline.shown)}: ${step.reason}`;
  if (status.ending && (status.detail || status.ending !== "found")) return sentence(status.detail || "the search has ended");
  if (status.detail) return `${sentence(status.detail)} The robot stands still after its present action; STOP works as ever.`;
  if (status.state === "resuming") return `${STATES.resuming}.`;
  if (isSilent(status)) return `The robot has been silent for ${span(silentS(status))}.`;
  if (!step && status.last?.mode) return `${MODES[status.last.mode]}: ${status.last.reason}`;
  if (!step) return status.state === "deciding" ? "Deciding about the first image …" : "Waiting for the robot’s first image.";
  return `${timeline.doing(timeline.shown)}: ${step.reason}` + (status.state === "deciding" ? " · deciding …" : "");
}

/** Where a robot that didn’t know its start is in the server’s memory. */
function startWords(start) {
  if (start.sure) return `Start: found on floor ${start.floor} of the memory by one turn.`;
  return `Start: not found in the memory: ${start.doubt}. The search began anew; the memory stays as it was.`;
}

const sentence = (words) => (/^\S+:\/\//.test(words) ? words : words.charAt(0).toUpperCase() + words.slice(1)) + (/[.!?]$/.test(words) ? "" : ".");

/** Names the floor of the map and offers the others, once there is more than one. */
function showFloor(steps, floorWords, floor) {
  const floors = [...new Set(steps.map(floorOf))].sort((a, b) => a - b);
  const isNamed = timeline.shown >= 0 && namesFloors(steps);
  byId("map-title").textContent = isNamed ? `Map of floor ${floor}` : "Map";
  byId("floor-words").hidden = !isNamed;
  byId("floors").hidden = floors.length < 2;
  if (!isNamed) return;
  const box = byId("floors");
  const words = floors.map((one) => floorWords[one] ?? `Floor ${one}`);
  // Buttons stay as long as the floors do, so that they keep the focus.
  if (box.dataset.floors !== String(words)) box.replaceChildren(...floors.map((one, k) => floorButton(one, words[k])));
  box.dataset.floors = String(words);
  for (const button of box.children) button.setAttribute("aria-pressed", String(Number(button.dataset.floor) === floor));
  const where = whereIs(steps, timeline.shown);
  const robot = where === `on floor ${floor}` ? "The robot is here." : `The robot is ${where}.`;
  byId("floor-words").textContent = `${words[floors.indexOf(floor)]}. ${robot}`;
}

function floorButton(floor, words) {
  const button = element("button", { type: "button", "data-floor": String(floor) }, words);
  button.addEventListener("click", () => { floorChosen = floor; show(); });
  return button;
}

function mapWords(map, step, floor) {
  const size = map ? `${(map.extent.columns * map.extent.resolution_m).toFixed(1)} by ${(map.extent.rows * map.extent.resolution_m).toFixed(1)} metres` : "none yet";
  const at = `robot at ${metres(step.pose[0])}, ${metres(step.pose[1])}`;
  const to = step.destination ? `, going to ${metres(step.destination[0])}, ${metres(step.destination[1])}` : "";
  return floorOf(step) === floor ? `Map: ${size}, ${at}${to}` : `Map: ${size}, without the robot`;
}

function driven(steps, last) {
  let length = 0;
  for (let n = 1; n <= last; n += 1) length += Math.hypot(steps[n].pose[0] - steps[n - 1].pose[0], steps[n].pose[1] - steps[n - 1].pose[1]);
  return length;
}

let imageShown = null;
let isFetching = false;

/** Images come one after the other; late ones are skipped. */
async function showCamera(from, step) {
  if (isFetching || imageShown === step) return;
  isFetching = true;
  try {
    const image = await from.image(step.step);
    if (from !== follower) return;
    byId("camera-words").textContent = sentence(drawCamera(byId("camera"), image, step));
    imageShown = step;
  } catch {
    await pause(500);
  } finally {
    isFetching = false;
  }
  const newest = follower.steps[timeline.shown];
  if (newest && newest !== imageShown) showCamera(follower, newest);
}

function showQuestion(steps) {
  const step = steps.findLast((one) => one.exchanges.length);
  const exchange = step?.exchanges.at(-1);
  byId("question-box").hidden = !exchange;
  if (!exchange) {
    byId("asked").textContent = "Nothing was asked up to this step.";
    byId("answer").textContent = byId("answered").textContent = "";
    return;
  }
  const chosen = exchange.chosen === null ? "" : `Block ${exchange.chosen} was chosen. `;
  const took = exchange.by_model ? ` after ${exchange.seconds.toFixed(1)} s` : "";
  byId("asked").textContent = `Step ${step.step + 1}: ${QUESTIONS[exchange.kind] ?? exchange.kind}`;
  byId("answer").textContent = exchange.answer;
  byId("answered").textContent = `${chosen}Answered by ${exchange.asked}${took}`;
  byId("question").textContent = exchange.question;
}

const time = (seconds) => new Date(seconds * 1000).toLocaleString([], { dateStyle: "medium", timeStyle: "short" });

async function list() {
  let shown = "";
  for (;;) {
    try {
      const found = await getJson("v1/searches?most=100");
      const latest = found[0];
      const isBusy = follower && (isChosen || follower.status?.state !== "ended");
      if (latest && latest.id !== follower?.id && !isBusy) follow(latest.id);
      goalBox.searching = found.filter((one) => !one.ending).map((one) => one.goal);
      byId("empty").hidden = found.length > 0 || goalBox.robots.length > 0;
      const now = JSON.stringify([follower?.id, found.map((one) => [one.id, stateWord(one), one.next_sequence])]);
      if (now !== shown) showList(found);
      shown = now;
    } catch {
      // The connection line says so.
    }
    await pause(POLL_MS);
  }
}

function stateWord(search) {
  if (search.ending) return search.ending;
  if (isSilent(search)) return `silent for ${span(silentS(search))}`;
  return search.state === "resuming" ? "resuming" : "under way";
}

function showList(searches) {
  byId("no-searches").hidden = searches.length > 0;
  const focused = document.activeElement?.dataset?.id;
  byId("searches").replaceChildren(...searches.map((search) => {
    const button = element(
      "button", { type: "button", "data-id": search.id, "aria-current": String(search.id === follower?.id) },
      element("span", { class: "goal" }, search.goal),
      element("span", { class: search.ending === "found" ? "good" : "muted" }, stateWord(search)),
      element("span", { class: "when" }, `${time(search.opened_s)} · ${search.next_sequence} steps`),
    );
    button.addEventListener("click", () => {
      isChosen = true;
      follow(search.id);
      for (const one of byId("searches").querySelectorAll("button")) one.setAttribute("aria-current", String(one === button));
    });
    return element("li", {}, button);
  }));
  if (focused) byId("searches").querySelector(`[data-id="${focused}"]`)?.focus();
}

function showConnection() {
  byId("connection").textContent = CONNECTION[connection.state];
  byId("connection").dataset.state = connection.state;
}

byId("legend").replaceChildren(...LEGEND.map(([words, color, shape]) => element("li", {}, swatch(color, shape), words)));
connection.addEventListener("state", showConnection);
window.addEventListener("resize", show);
setInterval(() => { if (follower?.status && isSilent(follower.status)) show(); }, POLL_MS);
byId("pause").addEventListener("click", pauseOrResume);
armToken();
armStop();
byId("try").textContent = `hypernav robot wait --server ${location.origin} --scene houses:7${hasToken() ? " --token-file FILE" : ""}`;
const goalBox = new GoalBox(() => { isChosen = false; });
new Memory(goalBox);
list();
getJson("v1/health").then(({ version }) => { byId("version").textContent = version; }).catch(() => {});
