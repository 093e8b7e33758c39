"use strict";
(() => {
  const { runs, searches, reload } = JSON.parse(document.getElementById("content").textContent);
  const MOST_ROWS = 200;
  const byId = (id) => document.getElementById(id);
  const made = (name, attributes = {}, ...children) => {
    const one = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) one.setAttribute(key, value);
    one.append(...children);
    return one;
  };
  runs.forEach((run, number) => Object.assign(run, { number, id: run.name }));
  searches.forEach((search) => {
    const run = runs[search.run];
    Object.assign(search, { id: `${run.name}/${search.key}`, name: run.name, agent: run.agent, commit: run.commit, differs: run.differs, when: run.when });
  });

  // Filters, sorting and what is chosen are kept in the address, so that a reload keeps them.
  const isUsed = ([name]) => !["commit", "differs"].includes(name) || runs.some((run) => run[name]);
  const FILTERS = Object.fromEntries([
    ["agent", "Agent"], ["goal", "Goal"], ["building", "Building"], ["outcome", "Outcome"], ["commit", "Commit"],
  ].filter(isUsed));
  const kept = () => new URLSearchParams(location.hash.slice(1));
  const keep = (name, ...values) => {
    const now = kept();
    now.delete(name);
    for (const value of values) if (value) now.append(name, value);
    history.replaceState(null, "", `#${now}`);
    show();
  };
  for (const [name, words] of Object.entries(FILTERS)) {
    const values = [...new Set(searches.map((one) => one[name]))].sort();
    const select = made("select", { "data-filter": name }, made("option", { value: "" }, "all"));
    for (const value of values) select.append(made("option", { value: `=${value}` }, value || "unknown"));
    select.value = kept().get(name) ?? "";
    select.addEventListener("change", () => keep(name, select.value));
    byId("filters").append(made("label", {}, words, select));
  }
  const text = made("input", { type: "search", "data-filter": "text", placeholder: "any word of a row" });
  text.value = kept().get("text") ?? "";
  text.addEventListener("input", () => keep("text", text.value));
  byId("filters").append(made("label", {}, "Words", text));

  const passing = () => {
    const now = kept();
    const words = (now.get("text") ?? "").toLowerCase().split(" ").filter(Boolean);
    return searches.filter((one) => {
      if (Object.keys(FILTERS).some((name) => now.get(name) && `=${one[name]}` !== now.get(name))) return false;
      const row = `${one.name} ${one.agent} ${one.goal} ${one.building} ${one.outcome} ${one.differs} ${one.why}`.toLowerCase();
      return words.every((word) => row.includes(word));
    });
  };

  const mean = (values) => (values.length ? values.reduce((sum, one) => sum + one, 0) / values.length : NaN);
  const percent = (share) => (Number.isNaN(share) ? "–" : `${(100 * share).toFixed(1)} %`);
  const decimal = (value, digits) => (typeof value === "number" && !Number.isNaN(value) ? value.toFixed(digits) : "–");
  const summary = (own) => {
    const counted = own.filter((one) => one.counts);
    return {
      done: own.length, success: mean(counted.map((one) => Number(one.success))),
      spl: mean(counted.map((one) => one.spl)), steps: mean(counted.map((one) => one.steps)),
    };
  };

  const RUN_COLUMNS = [
    ["name", "Run"], ["when", "Changed"], ["agent", "Agent"], ["differs", "Differs in"], ["of", "Data"], ["commit", "Commit"],
    ["done", "Searches", (run) => `${run.done}${run.wanted && run.wanted !== run.all ? ` (${run.all} of ${run.wanted} done)` : ""}`],
    ["success", "Success", (run) => percent(run.success)], ["spl", "SPL", (run) => decimal(run.spl, 3)],
    ["steps", "Steps", (run) => decimal(run.steps, 0)], ["ended", "State", (run) => run.ended.split(":")[0]],
  ].filter(isUsed);
  const SEARCH_COLUMNS = [
    ["goal", "Goal"], ["building", "Building"], ["name", "Run"], ["agent", "Agent"], ["differs", "Differs in"], ["outcome", "Outcome"],
    ["spl", "SPL", (one) => decimal(one.spl, 3)], ["steps", "Steps"], ["path", "Path, m", (one) => decimal(one.path, 1)],
    ["commit", "Commit"], ["film", "Film", (one) => (one.film ? "film" : one.page ? "page" : "")],
  ].filter(isUsed);
  const NUMBERS = new Set(["done", "success", "spl", "steps", "path"]);
  const chosenOf = (kind) => kept().getAll(kind);

  const fill = (kind, columns, rows) => {
    const [by, down] = (kept().get(`${kind}-by`) ?? "").split(" ");
    if (by) {
      const sign = down ? -1 : 1;
      const value = (one) => (Number.isNaN(one[by]) ? null : one[by] ?? null);
      rows = [...rows].sort((a, b) => {
        const [x, y] = [value(a), value(b)];
        if (x === null || y === null) return Number(x === null) - Number(y === null);
        return sign * (typeof x === "number" ? x - y : String(x).localeCompare(String(y), undefined, { numeric: true }));
      });
    }
    const head = made("tr", {}, ...columns.map(([name, words]) => {
      const cell = made("th", { scope: "col", ...(NUMBERS.has(name) && { class: "number" }) }, made("button", { type: "button" }, words));
      if (by === name) cell.setAttribute("aria-sort", down ? "descending" : "ascending");
      cell.firstChild.addEventListener("click", () => keep(`${kind}-by`, by === name && !down ? `${name} down` : name));
      return cell;
    }));
    const chosen = chosenOf(kind);
    const body = rows.slice(0, MOST_ROWS).map((one) => {
      const row = made("tr", { tabindex: "0", "aria-selected": String(chosen.includes(one.id)) });
      columns.forEach(([name, words, said], n) => {
        const shown = String(said ? said(one) : one[name] ?? "");
        row.append(n ? made("td", { "data-name": words, ...(NUMBERS.has(name) && { class: "number" }) }, shown) : made("th", { scope: "row" }, shown));
      });
      const choose = () => {
        const others = chosenOf(kind).filter((id) => id !== one.id);
        keep(kind, ...(chosen.includes(one.id) ? others : [...others.slice(-1), one.id]));
        byId("chosen").scrollIntoView({ block: "nearest" });
      };
      row.addEventListener("click", choose);
      row.addEventListener("keydown", (event) => { if (event.key === "Enter" && event.target === row) choose(); });
      return row;
    });
    byId(kind).replaceChildren(made("thead", {}, head), made("tbody", {}, ...body));
    return rows.length;
  };

  const facts = (pairs) => made("dl", { class: "facts small" }, ...pairs.map(([name, value]) => made("div", {}, made("dt", {}, `${name}: `), made("dd", {}, String(value)))));
  const card = (one) => {
    const shown = made("div", {}, made("h3", {}, `${one.goal} in ${one.building}`),
      facts([["Run", one.name], ["Agent", one.agent], ["Outcome", one.outcome], ["SPL", decimal(one.spl, 3)], ["Steps", one.steps], ["Path", `${decimal(one.path, 1)} m`]]));
    if (one.why) shown.append(made("p", { class: "small" }, one.why));
    if (one.film) shown.append(made("video", { src: one.film, controls: "", muted: "", playsinline: "", preload: "metadata" }));
    else shown.append(made("p", { class: "small muted" }, "Its film was not kept; eval keeps films with --save videos or --save failures."));
    if (one.page) shown.append(made("p", {}, made("a", { href: one.page }, "Its page, with the map and every decision")));
    return shown;
  };

  // Two runs are compared on the searches that both have made, each episode with its twin.
  const comparison = (first, second, rows) => {
    const own = (run) => new Map(rows.filter((one) => one.run === run.number && one.counts).map((one) => [one.key, one]));
    const [a, b] = [own(first), own(second)];
    const pairs = [...a.keys()].filter((key) => b.has(key)).map((key) => [a.get(key), b.get(key)]);
    const shown = made("div", {}, made("h3", {}, `${first.name} and ${second.name}`));
    if (!pairs.length) {
      shown.append(made("p", {}, "No search was made by both: their buildings, goals, starts or episodes differ."));
      return shown;
    }
    const [left, right] = [0, 1].map((side) => summary(pairs.map((pair) => pair[side])));
    const line = (words, x, y, said) => made("tr", {}, made("th", { scope: "row" }, words), made("td", { "data-name": first.name }, said(x)), made("td", { "data-name": second.name }, said(y)), made("td", { "data-name": "difference" }, `${y - x >= 0 ? "+" : "−"}${said(Math.abs(y - x)).replace("%", "points")}`));
    shown.append(made("p", { class: "small" }, `${pairs.length} search${pairs.length === 1 ? "" : "es"} that both have made:`), made("table", {},
      made("thead", {}, made("tr", {}, ...["", first.name, second.name, "difference"].map((words) => made("th", { scope: "col" }, words)))),
      made("tbody", {}, line("Success", left.success, right.success, percent), line("SPL", left.spl, right.spl, (x) => decimal(x, 3)), line("Steps", left.steps, right.steps, (x) => decimal(x, 0)))));
    for (const [words, is] of [[`Only ${first.name} found`, ([x, y]) => x.success && !y.success], [`Only ${second.name} found`, ([x, y]) => !x.success && y.success]]) {
      const only = pairs.filter(is);
      const list = made("ul", { class: "small" }, ...only.slice(0, 30).map((pair) => {
        const button = made("button", { type: "button" }, `${pair[0].goal} in ${pair[0].building}`);
        button.addEventListener("click", () => keep("searches", ...pair.map((one) => one.id)));
        return made("li", {}, button);
      }));
      if (only.length) shown.append(made("p", { class: "small" }, `${words} (${only.length}):`), list);
    }
    return shown;
  };

  let before = "";
  const showChosen = (rows) => {
    const [chosenRuns, chosenSearches] = [[runs, "runs"], [searches, "searches"]].map(([all, kind]) => chosenOf(kind).map((id) => all.find((one) => one.id === id)).filter(Boolean));
    const now = JSON.stringify([chosenRuns, chosenSearches, rows.length]);
    if (now === before) return; // a film that plays goes on
    before = now;
    const parts = [];
    if (chosenRuns.length === 2) parts.push(comparison(...chosenRuns, rows));
    else if (chosenRuns.length) parts.push(made("p", {}, `Chosen: ${chosenRuns[0].name} (${chosenRuns[0].ended}). Click another run to compare the two.`));
    if (chosenSearches.length) parts.push(made("div", { class: "pair" }, ...chosenSearches.map(card)));
    byId("chosen").hidden = !parts.length;
    byId("chosen").replaceChildren(...parts);
  };

  const show = () => {
    const rows = passing();
    const of = Map.groupBy ? Map.groupBy(rows, (one) => one.run) : rows.reduce((all, one) => all.set(one.run, [...(all.get(one.run) ?? []), one]), new Map());
    const all = new Map();
    for (const one of searches) all.set(one.run, (all.get(one.run) ?? 0) + 1);
    const filtered = rows.length < searches.length;
    const shown = runs.filter((run) => !filtered || of.has(run.number)).map((run) => ({ ...run, all: all.get(run.number) ?? 0, ...summary(of.get(run.number) ?? []) }));
    fill("runs", RUN_COLUMNS, shown);
    const count = fill("searches", SEARCH_COLUMNS, rows);
    byId("more").textContent = count > MOST_ROWS ? `The first ${MOST_ROWS} of ${count}; sort or filter to see others.` : "";
    byId("counted").textContent = `${shown.length} of ${runs.length} runs, ${rows.length} of ${searches.length} searches`;
    showChosen(rows);
  };
  show();
  const isPlaying = () => [...document.querySelectorAll("video")].some((film) => !film.paused && !film.ended);
  if (reload) setInterval(() => { if (!isPlaying() && !document.activeElement?.matches("input, select")) location.reload(); }, 1000 * reload);
})();
