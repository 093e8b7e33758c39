"use strict";
(() => {
  const walk = JSON.parse(document.getElementById("places").textContent);
  const tour = document.getElementById("tour");
  const eye = document.getElementById("eye");
  const canvas = eye.querySelector("canvas");
  const pen = canvas.getContext("2d");
  const drawing = document.querySelector("#drawing svg");
  const rooms = document.getElementById("rooms");
  const still = matchMedia("(prefers-reduced-motion: reduce)");
  const RADIANS = Math.PI / 180;
  const SLICE = (2 * Math.PI) / walk.slices;
  const WINDS = ["east", "north-east", "north", "north-west", "west", "south-west", "south", "south-east"];
  const FADE_MS = 220;
  const MOST_NAMED = 4;
  const wrap = (degrees) => ((((degrees + 180) % 360) + 360) % 360) - 180;

  let at = walk.start.at;
  let heading = walk.start.heading; // Of the view that is drawn; it follows `wanted`. Degrees.
  let wanted = heading;
  let shown = null; // The panorama, and the one that it replaces while it fades in.
  let before = null;
  let since = 0;

  // A panorama is a prism of flat images. Every column of the view takes its column of the prism,
  // so the view is what a camera sees that looks this way, with straight lines straight.
  const halfField = () => Math.atan((walk.slope * canvas.width) / canvas.height);
  const draw = (image) => {
    const { width, height } = canvas;
    const focal = height / 2 / walk.slope;
    const wide = image.width / walk.slices;
    const from = wide / 2 / Math.tan(SLICE / 2);
    const strip = Math.max(1, Math.round(width / 480));
    for (let x = 0; x < width; x += strip) {
      const angle = Math.atan((x + strip / 2 - width / 2) / focal);
      const turned = ((wrap(-heading) + 180) * RADIANS + angle + 2 * Math.PI) % (2 * Math.PI);
      const slice = Math.floor(turned / SLICE);
      const off = turned - (slice + 0.5) * SLICE;
      const ratio = Math.cos(angle) / Math.cos(off);
      const source = (strip * from * ratio * ratio) / focal;
      const left = slice * wide + wide / 2 + from * Math.tan(off) - source / 2;
      const half = from * walk.slope * ratio;
      pen.drawImage(
        image, Math.min(Math.max(left, 0), image.width - source), image.height / 2 - half,
        source, 2 * half, x, 0, strip, height,
      );
    }
  };

  let asked = false;
  const paint = (now) => {
    asked = false;
    const far = wanted - heading;
    heading = still.matches || Math.abs(far) < 0.2 ? wanted : heading + far * 0.22;
    const fade = still.matches || !before ? 1 : Math.min((now - since) / FADE_MS, 1);
    if (fade < 1) {
      draw(before);
      pen.globalAlpha = fade;
    } else before = null;
    if (shown) draw(shown);
    pen.globalAlpha = 1;
    me.setAttribute("transform", `translate(${spot(walk.positions[at].at)}) rotate(${-heading})`);
    if (fade < 1 || heading !== wanted) repaint();
  };
  const repaint = () => {
    if (!asked) requestAnimationFrame(paint);
    asked = true;
  };

  // Panoramas that may be needed next are decoded before they are.
  const images = new Map();
  const imageAt = (n) => {
    if (!images.has(n)) {
      const image = new Image();
      image.src = `data:image/webp;base64,${walk.panoramas[n]}`;
      images.set(n, image.decode().then(() => image));
      if (images.size > 24) images.delete(images.keys().next().value);
    }
    return images.get(n);
  };

  // The plan: metres, y up in the scene and down in the drawing.
  const part = (name, attributes, parent) => {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const key in attributes) made.setAttribute(key, attributes[key]);
    return parent.appendChild(made);
  };
  const spot = ([x, y]) => `${x} ${-y}`;
  const box = drawing.viewBox.baseVal;
  const unit = Math.max(box.width, box.height * 1.2) / 100;
  const found = part("g", { class: "found", "stroke-width": 0.5 * unit }, drawing);
  const dots = walk.positions.map(({ at: [x, y] }) =>
    part("circle", { class: "place", cx: x, cy: -y, r: 0.65 * unit }, drawing));
  const me = part("g", {}, drawing);
  const sight = part("path", { class: "sight" }, me);
  const arrow = `M${2.4 * unit} 0L${-1.6 * unit} ${1.5 * unit}L${-0.8 * unit} 0L${-1.6 * unit} ${-1.5 * unit}Z`;
  part("path", { class: "me", "stroke-width": 0.6 * unit, d: arrow }, me);

  // The neighbour that lies best in a direction: near to it, and near.
  const MOST_ASIDE = 65;
  const towards = (direction) => {
    const here = walk.positions[at];
    let best = null;
    for (const n of here.next) {
      const dx = walk.positions[n].at[0] - here.at[0];
      const dy = walk.positions[n].at[1] - here.at[1];
      const course = Math.atan2(dy, dx) / RADIANS;
      const aside = Math.abs(wrap(course - direction));
      const cost = Math.hypot(dx, dy) * (1 + (aside / 25) ** 2);
      if (aside <= MOST_ASIDE && (!best || cost < best.cost)) best = { n, course, cost };
    }
    return best;
  };

  const named = (seen) => {
    const kinds = new Map();
    for (const [name, , tenths] of seen) {
      const [count, nearest] = kinds.get(name) || [0, Infinity];
      kinds.set(name, [count + 1, Math.min(nearest, tenths)]);
    }
    return [...kinds].slice(0, MOST_NAMED).map(([name, [count, nearest]]) =>
      `${count > 1 ? `${count} × ` : ""}${walk.names[name]} ${count > 1 ? "from " : ""}${nearest / 10} m`,
    ).join(", ") || "nothing named";
  };

  // What is said follows when the view has come to rest.
  let pause = 0;
  const say = (wait, remark = "") => {
    clearTimeout(pause);
    pause = setTimeout(() => {
      const { room, seen } = walk.positions[at];
      const wind = WINDS[((Math.round(wanted / 45) % 8) + 8) % 8];
      const place = room ? room[0].toUpperCase() + room.slice(1) : "Doorway";
      document.getElementById("room").textContent = `${place}, looking ${wind}. ${remark}`.trim();
      const edge = Math.tan(halfField());
      const thirds = [[], [], []];
      for (const one of seen) {
        const aside = wrap(one[1] - wanted);
        if (Math.abs(aside) >= 89) continue;
        const across = Math.tan(aside * RADIANS) / edge;
        if (Math.abs(across) < 1) thirds[across > 1 / 3 ? 0 : across < -1 / 3 ? 2 : 1].push(one);
      }
      document.querySelectorAll("#here dd").forEach((cell, n) => { cell.textContent = named(thirds[n]); });
    }, wait);
    const next = towards(wanted);
    dots.forEach((dot, n) => dot.classList.toggle("next", next !== null && n === next.n));
  };

  const turn = (degrees, wait = 250) => {
    wanted += degrees;
    say(wait);
    repaint();
  };
  const go = (n, course = wanted) => {
    wanted += wrap(course - wanted);
    at = n;
    rooms.value = walk.positions[n].room;
    say(250);
    imageAt(n).then((image) => {
      if (n !== at) return;
      before = shown;
      shown = image;
      since = performance.now();
      repaint();
      for (const other of walk.positions[n].next) imageAt(other);
    });
    repaint();
  };
  const drive = (aside) => {
    const next = towards(wanted + aside);
    if (next) go(next.n, next.course - (Math.abs(aside) > 90 ? aside : 0));
    else say(0, Math.abs(aside) > 90 ? "No way back there: turn first." : "No way there: turn first.");
  };

  for (const button of document.querySelectorAll("#walk button")) {
    const { turn: sense, drive: aside } = button.dataset;
    button.addEventListener("click", () => (sense ? turn(sense * walk.turn) : drive(Number(aside))));
  }
  const keys = {
    ArrowLeft: () => turn(walk.turn),
    ArrowRight: () => turn(-walk.turn),
    ArrowUp: () => drive(0),
    ArrowDown: () => drive(180),
  };
  document.getElementById("walk").addEventListener("keydown", (event) => {
    if (event.target === rooms || event.ctrlKey || event.altKey || event.metaKey) return;
    if (!Object.hasOwn(keys, event.key)) return;
    event.preventDefault();
    keys[event.key]();
  });

  // Dragging takes the view along; a click into it drives that way.
  let drag = null;
  const degreesAt = (x) => {
    const { left, width, height } = canvas.getBoundingClientRect();
    return Math.atan((x - left - width / 2) / (height / 2 / walk.slope)) / RADIANS;
  };
  eye.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    drag = { x: event.clientX, moved: 0 };
    eye.setPointerCapture(event.pointerId);
  });
  eye.addEventListener("pointermove", (event) => {
    if (!drag) return;
    const by = degreesAt(event.clientX) - degreesAt(drag.x);
    drag.moved += Math.abs(event.clientX - drag.x);
    drag.x = event.clientX;
    turn(by, 400);
    heading = wanted;
  });
  eye.addEventListener("pointerup", (event) => {
    if (drag && drag.moved < 6) drive(-degreesAt(event.clientX));
    drag = null;
  });
  eye.addEventListener("pointercancel", () => { drag = null; });
  drawing.addEventListener("click", (event) => {
    const { x, y } = new DOMPoint(event.clientX, event.clientY)
      .matrixTransform(drawing.getScreenCTM().inverse());
    const away = walk.positions.map(({ at: place }) => Math.hypot(place[0] - x, place[1] + y));
    go(away.indexOf(Math.min(...away)));
  });

  for (const room of [...new Set(walk.positions.map((place) => place.room))].filter(Boolean)) {
    rooms.add(new Option(room));
  }
  rooms.addEventListener("change", () => {
    go(walk.positions.findIndex((place) => place.room === rooms.value));
  });

  // A row of the table marks its objects on the plan.
  const status = document.getElementById("search");
  const cells = [...document.querySelectorAll("th[data-name]")];
  for (const cell of cells) {
    const button = document.createElement("button");
    const name = cell.dataset.name;
    button.type = "button";
    button.textContent = name;
    button.setAttribute("aria-pressed", "false");
    cell.replaceChildren(button);
    button.addEventListener("click", () => {
      const chosen = button.getAttribute("aria-pressed") === "false";
      for (const other of cells) other.firstChild.setAttribute("aria-pressed", "false");
      button.setAttribute("aria-pressed", String(chosen));
      found.replaceChildren();
      if (chosen) for (const [x, y] of walk.where[name]) part("circle", { cx: x, cy: -y, r: 1.6 * unit }, found);
      status.textContent = chosen
        ? `Marked in red on the plan: ${name} (${walk.where[name].length}).`
        : "Choose an object to see on the plan where it is.";
    });
  }

  new ResizeObserver(() => {
    const scale = Math.min(devicePixelRatio, 2);
    canvas.width = Math.round(eye.clientWidth * scale);
    canvas.height = Math.round(eye.clientHeight * scale);
    if (canvas.height === 0) return; // not laid out, as while the page is left
    const reach = 9 * unit;
    const [x, y] = [reach * Math.cos(halfField()), reach * Math.sin(halfField())];
    sight.setAttribute("d", `M0 0L${x} ${-y}A${reach} ${reach} 0 0 1 ${x} ${y}Z`);
    say(0);
    repaint();
  }).observe(eye);
  tour.classList.add("walking");
  tour.classList.toggle("wide", box.width > 1.6 * box.height);
  for (const id of ["walk", "keys", "search"]) document.getElementById(id).hidden = false;
  document.getElementById("plan").textContent = "Walk through the plan";
  drawing.setAttribute("aria-label", "Floor plan; the arrow is where you stand");
  go(at);
})();
