// Making elements. Texts are set as texts, so nothing that a model or a robot says becomes markup.

const SVG = "http://www.w3.org/2000/svg";

export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

/** A coordinate in metres; what rounds to zero has no sign. */
export function metres(x) {
  return (Math.round(10 * x) / 10 || 0).toFixed(1);
}

/** A sample of a colour; as a drawing, since the page allows no styles of its own. */
export function swatch(color, shape = "M1 1h14v14H1z") {
  const drawing = document.createElementNS(SVG, "svg");
  drawing.setAttribute("viewBox", "0 0 16 16");
  drawing.setAttribute("aria-hidden", "true");
  const path = document.createElementNS(SVG, "path");
  path.setAttribute("d", shape);
  path.setAttribute("fill", color);
  drawing.append(path);
  return drawing;
}
