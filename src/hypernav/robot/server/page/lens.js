// The part of the map that is shown: nearer, farther, and moved, by mouse, finger and keys.

const MOST = 16;

/** Zoom and middle of the map, relative to the whole of it. Calls `onChange()`. */
export class Lens {
  zoom = 1;
  aside = [0, 0]; // of the middle, metres
  scale = 1; // pixels of the screen a metre, noted by whoever draws

  constructor(canvas, buttons, onChange) {
    this.canvas = canvas;
    this.onChange = onChange;
    this.fingers = new Map();
    for (const button of buttons) button.addEventListener("click", () => this.nearer(Number(button.dataset.zoom)));
    canvas.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && this.zoom === 1 && event.deltaY > 0) return; // the page scrolls on
      event.preventDefault();
      this.nearer(Math.exp(-event.deltaY / 400), this.off(event));
    }, { passive: false });
    canvas.addEventListener("pointerdown", (event) => {
      this.fingers.set(event.pointerId, event);
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => this.drag(event));
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, (event) => this.fingers.delete(event.pointerId));
  }

  /** Where an event lies beside the middle of the canvas, metres to the right and up. */
  off(event) {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    return [(event.clientX - left - width / 2) / this.scale, (top + height / 2 - event.clientY) / this.scale];
  }

  nearer(factor, [right, up] = [0, 0]) {
    const zoom = factor ? Math.min(Math.max(this.zoom * factor, 1), MOST) : 1;
    const kept = 1 - this.zoom / zoom; // what lies under the pointer stays there
    this.aside = zoom === 1 ? [0, 0] : [this.aside[0] + right * kept, this.aside[1] + up * kept];
    this.zoom = zoom;
    this.canvas.dataset.zoomed = String(zoom > 1);
    this.onChange();
  }

  drag(event) {
    const before = this.fingers.get(event.pointerId);
    if (!before) return;
    const other = [...this.fingers.values()].find((one) => one.pointerId !== event.pointerId);
    this.fingers.set(event.pointerId, event);
    if (other) {
      const away = (one) => Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY);
      if (away(before) > 0) this.nearer(away(event) / away(before), this.off(event));
    } else if (this.zoom > 1) {
      this.aside = [this.aside[0] - (event.clientX - before.clientX) / this.scale, this.aside[1] + (event.clientY - before.clientY) / this.scale];
      this.onChange();
    }
  }
}
