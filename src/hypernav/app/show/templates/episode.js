"use strict";
(() => {
  const player = JSON.parse(document.getElementById("player").textContent);
  const video = document.getElementById("video");
  const slider = document.getElementById("slider");
  const now = document.getElementById("now");
  const robot = document.getElementById("robot");
  const destination = document.getElementById("destination");
  const rows = [...document.querySelectorAll(".moment")];
  const floors = [...document.querySelectorAll("figure[data-floor]")];
  const tabs = [...document.querySelectorAll("button[data-floor]")];
  const onStairs = [...document.querySelectorAll(".on-stairs")];
  if (!slider) return;

  // A chosen floor stays until the robot goes to another.
  let floorOfRobot = null;
  const showFloor = (floor) => {
    for (const one of floors) one.hidden = Number(one.dataset.floor) !== floor;
    for (const tab of tabs) tab.setAttribute("aria-pressed", String(Number(tab.dataset.floor) === floor));
  };
  const followTo = (floor) => {
    if (floor === floorOfRobot) return;
    floorOfRobot = floor;
    showFloor(floor);
    const map = floors.find((one) => Number(one.dataset.floor) === floor)?.querySelector("svg");
    if (map && robot) map.append(destination, robot);
  };
  for (const tab of tabs) tab.addEventListener("click", () => showFloor(Number(tab.dataset.floor)));

  // A blob can be sought everywhere; some browsers cannot seek in a data address.
  if (video && video.src.startsWith("data:")) {
    const bytes = Uint8Array.from(atob(video.src.split(",")[1]), (c) => c.charCodeAt(0));
    video.src = URL.createObjectURL(new Blob([bytes], { type: "video/mp4" }));
  }

  const placeAt = (time) => {
    let low = 0;
    let high = player.times.length;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (player.times[middle] <= time + 1e-3) low = middle;
      else high = middle;
    }
    return low;
  };

  const show = (place) => {
    const reason = player.reasons[place];
    now.textContent =
      `Step ${player.steps[place]} · ${player.modes[place]}` + (reason ? ` · ${reason}` : "");
    slider.value = place;
    slider.setAttribute("aria-valuetext", now.textContent);
    followTo(player.floors[place]);
    document.dispatchEvent(new CustomEvent("step-shown", { detail: player.steps[place] - 1 }));
    for (const words of onStairs) words.hidden = !player.climbing[place];
    if (robot && player.robots.length) {
      const here = player.robots[place];
      robot.setAttribute("visibility", here ? "visible" : "hidden");
      if (here) robot.setAttribute("transform", `translate(${here[0]} ${here[1]}) rotate(${here[2]})`);
      const at = player.destinations[place];
      destination.setAttribute("visibility", at ? "visible" : "hidden");
      if (at) destination.setAttribute("transform", `translate(${at[0]} ${at[1]})`);
    }
    // What is folded is told by what it is folded into.
    let current = null;
    for (const row of rows) {
      const isFolded = row.parentElement.closest("details:not([open])");
      if (!isFolded && Number(row.dataset.place) <= place) current = row;
    }
    for (const row of rows) row.classList.toggle("current", row === current);
  };

  const seek = (place) => {
    if (video) video.currentTime = player.times[place] + 0.02;
    show(place);
  };

  slider.addEventListener("input", () => {
    if (video) video.pause();
    seek(Number(slider.value));
  });
  for (const button of document.querySelectorAll("button[data-place]")) {
    button.addEventListener("click", () => {
      seek(Number(button.dataset.place));
      if (video) video.scrollIntoView({ behavior: "smooth", block: "center" });
    });
  }
  if (video) {
    // The browser's own controls would cover the answers at the bottom of the film.
    const play = document.getElementById("play");
    const toggle = () => (video.paused ? video.play() : video.pause());
    const label = () => { play.textContent = video.paused ? "Play" : "Pause"; };
    video.controls = false;
    document.getElementById("controls").hidden = false;
    play.addEventListener("click", toggle);
    video.addEventListener("click", () => { if (!document.fullscreenElement) toggle(); });
    for (const event of ["play", "pause", "ended"]) video.addEventListener(event, label);
    const speed = document.getElementById("speed");
    speed.addEventListener("change", () => { video.playbackRate = Number(speed.value); });
    const full = document.getElementById("full");
    full.hidden = !document.fullscreenEnabled;
    full.addEventListener("click", () => video.requestFullscreen());
    document.addEventListener("fullscreenchange", () => {
      video.controls = document.fullscreenElement === video;
    });

    // Until somebody starts the film, the map shows where the robot ended.
    const follow = () => {
      if (video.currentTime > 0 || !video.paused) show(placeAt(video.currentTime));
    };
    for (const event of ["timeupdate", "seeked"]) video.addEventListener(event, follow);
    if ("requestVideoFrameCallback" in video) {
      const each = () => { follow(); video.requestVideoFrameCallback(each); };
      video.requestVideoFrameCallback(each);
    }
  }
  followTo(player.floors.at(-1));
  now.textContent = "Drag along the band, or choose a step below, to move through the episode.";

  // A report links to the step that decided a failure.
  const jump = () => {
    if (location.hash !== "#decisive" || player.decisive === null) return;
    seek(player.decisive);
    slider.scrollIntoView({ block: "center" });
  };
  window.addEventListener("hashchange", jump);
  jump();
})();
