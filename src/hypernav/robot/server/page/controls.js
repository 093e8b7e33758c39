// The operator's controls: a goal for a waiting robot, and STOP.

import { Refused, getJson, pause, post, request, rememberToken, connection } from "./server.js";
import { element, metres } from "./elements.js";

const POLL_MS = 1000;
const THINGS_MS = 5000;
const AGAIN_MS = 300;
const UNSURE_MS = 1000; // a STOP that the server has is confirmed in a tenth of this
const REASON = "the operator pressed STOP";

const byId = (id) => document.getElementById(id);

/** The goal box. Calls `onSent()` when a robot was given a goal. */
export class GoalBox {
  robots = [];
  note = "";
  searching = []; // goals of the searches under way

  constructor(onSent) {
    this.onSent = onSent;
    byId("find").addEventListener("submit", (event) => {
      event.preventDefault();
      this.send();
    });
    this.poll();
  }

  async poll() {
    for (;;) {
      try {
        this.show(await getJson("v1/robots"));
      } catch {
        this.show([]);
      }
      await pause(POLL_MS);
    }
  }

  show(robots) {
    this.robots = robots;
    const free = robots.filter((robot) => !robot.given);
    const select = byId("robot");
    if (free.map((robot) => robot.name).join() !== [...select.options].map((one) => one.value).join()) {
      const chosen = select.value;
      select.replaceChildren(...free.map(({ name }) => element("option", { value: name }, name)));
      if (free.some((robot) => robot.name === chosen)) select.value = chosen;
    }
    select.hidden = free.length < 2;
    byId("send").disabled = free.length === 0;
    for (const button of byId("things").querySelectorAll("button")) button.disabled = free.length === 0;
    byId("find-words").textContent = this.note || waitingWords(robots, free, this.searching);
  }

  /** Sends a robot to the goal in the box or, with `what`, to a remembered thing. */
  async send(what = { goal: byId("goal").value.trim() }) {
    const name = byId("robot").value;
    if (!what.goal || !name) return;
    byId("send").disabled = true;
    try {
      await post(`v1/robots/${encodeURIComponent(name)}/goal`, what);
      this.onSent();
      this.say("");
    } catch (error) {
      this.say(`That did not work: ${error.message}`);
    }
  }

  say(note) {
    this.note = note;
    this.show(this.robots);
    if (note) setTimeout(() => { if (this.note === note) this.say(""); }, 8000);
  }
}

/** The things of the memory, each with a button that sends a robot there. */
export class Memory {
  constructor(goalBox) {
    this.goalBox = goalBox;
    this.poll();
  }

  async poll() {
    let shown = "";
    for (;;) {
      try {
        const things = await getJson("v1/things");
        const now = JSON.stringify(things);
        if (now !== shown) this.show(things);
        shown = now;
        this.warn("");
      } catch (error) {
        if (error instanceof Refused && error.status !== 401) this.warn(error.message);
        // Else the connection line says so.
      }
      await pause(THINGS_MS);
    }
  }

  /** Says why the memory can't be read; what was read of it before stays. */
  warn(problem) {
    byId("memory-problem").textContent = problem;
    byId("memory-problem").hidden = !problem;
    byId("memory").hidden = !problem && !byId("things").children.length;
  }

  show(things) {
    byId("things").replaceChildren(...things.map(({ thing, label, position: [x, y], chance, no_way: noWay, has_image: hasImage }) => {
      const where = `floor ${thing.floor}, at ${metres(x)}, ${metres(y)} ·\u00a0${Math.round(100 * chance)}\u00a0%\u00a0sure`;
      const button = element("button", { type: "button", "aria-label": `Go to the ${label} on ${where}` }, "Go there");
      button.addEventListener("click", () => this.goalBox.send({ goal: label, thing }));
      const words = [element("span", { class: "when" }, where)];
      if (noWay) words.push(element("span", { class: "when why" }, `Note: ${noWay}.`));
      const picture = hasImage ? [pictureOf(thing, label)] : [];
      return element("li", {}, ...picture, element("span", { class: "goal" }, label), ...words, button);
    }));
    this.goalBox.show(this.goalBox.robots);
  }
}

const pictures = new IntersectionObserver((entries) => {
  for (const { isIntersecting, target } of entries) {
    if (!isIntersecting) continue;
    pictures.unobserve(target);
    drawPicture(target);
  }
});

/** The picture of a remembered thing, which is fetched when somebody comes to see it. */
function pictureOf({ floor, number }, label) {
  const canvas = element("canvas", { role: "img", "aria-label": `Picture of the ${label}`, width: "160", height: "160", "data-thing": `${floor}/${number}` });
  pictures.observe(canvas);
  return canvas;
}

async function drawPicture(canvas) {
  try {
    const image = await createImageBitmap(await (await request(`v1/things/${canvas.dataset.thing}/image`)).blob());
    const scale = Math.max(canvas.width / image.width, canvas.height / image.height);
    const [width, height] = [image.width * scale, image.height * scale];
    canvas.getContext("2d").drawImage(image, (canvas.width - width) / 2, (canvas.height - height) / 2, width, height);
    canvas.dataset.drawn = "true";
  } catch {
    canvas.hidden = true; // the list goes on without it
  }
}

function waitingWords(robots, free, searching) {
  const told = robots.find((robot) => robot.given);
  if (told) return `${told.name} was told to find “${told.given.goal}”, and begins.`;
  const refused = free.find((robot) => robot.refused);
  if (refused) return `${refused.name} could not begin: ${refused.refused}`;
  if (free.length === 1) return `${free[0].name} waits for a goal.`;
  if (free.length) return `${free.length} robots wait for a goal.`;
  if (searching.length === 1) return `The robot is looking for “${searching[0]}”; it takes a new goal when it waits again.`;
  if (searching.length) return `${searching.length} robots are searching; one takes a new goal when it waits again.`;
  return "No robot waits for a goal.";
}

/** The STOP button: pressed once, it is sent until the server has confirmed it. */
export function armStop() {
  const button = byId("stop");
  const alarm = byId("alarm");
  let isSending = false;
  button.addEventListener("click", async () => {
    if (isSending) return;
    isSending = true;
    button.textContent = "STOP …";
    const say = (words) => {
      alarm.textContent = `${words} Trying again … Use the robot’s own emergency stop!`;
      alarm.hidden = false;
    };
    const unsure = setTimeout(() => {
      say("The server has not confirmed STOP.");
      connection.enter("off");
    }, UNSURE_MS);
    while (isSending) {
      try {
        await post("v1/stop", { reason: REASON });
        alarm.hidden = true;
        isSending = false;
      } catch (error) {
        const fault = error instanceof Refused ? "The server has not confirmed STOP" : "STOP did not reach the server";
        say(`${fault} (${error.message}).`);
        await pause(AGAIN_MS);
      }
    }
    clearTimeout(unsure);
    button.textContent = "STOP";
  });
}

/** Asks for the token when the server requires it. */
export function armToken() {
  const dialog = byId("token-dialog");
  const words = byId("token-words");
  byId("token-form").addEventListener("submit", () => {
    rememberToken(byId("token").value.trim());
    connection.enter("connecting");
    byId("token").value = "";
    words.textContent = "This token was not accepted. Is it the one in the server’s file?";
  });
  connection.addEventListener("state", () => {
    if (connection.state === "token" && !dialog.open) dialog.showModal();
  });
}
