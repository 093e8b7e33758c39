"use strict";
(() => {
  const stage = document.getElementById("stage");
  const content = JSON.parse(document.getElementById("space-content").textContent);
  // Map frames may lie far from the building, and graphics compute with seven digits.
  const [east, north] = content.floors[0].corner;
  const near = ([x, y, ...z]) => [x - east, y - north, ...z];
  for (const floor of content.floors) floor.corner = near(floor.corner);
  for (const path of content.paths) path.points = path.points.map(near);
  for (const mark of content.marks) mark.rings = mark.rings.map((ring) => ring.map(near));
  for (const box of content.boxes) [box.low, box.high] = [near(box.low), near(box.high)];
  for (const view of content.views) view.corners = view.corners.map(near);
  const robots = content.robots ?? {};
  for (const step in robots) robots[step] = [robots[step][0], ...near(robots[step].slice(1))];
  if (content.cloud) content.cloud.origin = near(content.cloud.origin);
  const space = document.getElementById("space");
  const words = document.getElementById("space-words");
  space.hidden = false;

  const unpacked = (base64) => {
    const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip")));
  };
  const address = async (name) => {
    const text = await unpacked(document.getElementById(`library-${name}`).textContent).text();
    return URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
  };
  const loaded = async () => {
    const names = document.createElement("script");
    names.type = "importmap";
    names.textContent = JSON.stringify({ imports: { three: await address("three") } });
    document.head.append(names);
    const [three, { OrbitControls }] = await Promise.all([import("three"), import(await address("controls"))]);
    return { three, OrbitControls };
  };

  const begin = async () => {
    const { three, OrbitControls } = await loaded();
    const renderer = new three.WebGLRenderer({ antialias: true, alpha: true });
    const scene = new three.Scene();
    const camera = new three.PerspectiveCamera(40, 1, 0.1, 500);
    camera.up.set(0, 0, 1);
    const color = (name) => new three.Color(getComputedStyle(document.body).getPropertyValue(name).trim() || name);
    const ink = (name) => new three.MeshBasicMaterial({ color: color(name), side: three.DoubleSide });

    // Every floor is a group, which can be hidden, and moved up from those below it.
    const below = 1.5 * (content.cloud?.spacing ?? 0); // the map lies under the lowest points of its floor
    const floors = new Map();
    for (const floor of [...content.floors].sort((a, b) => a.z - b.z)) {
      const group = new three.Group();
      group.userData = { ...floor, rank: floors.size };
      const label = document.createElement("span");
      label.textContent = floor.words;
      stage.append(label);
      group.userData.label = label;
      const texture = new three.TextureLoader().load(floor.image, () => draw());
      texture.colorSpace = three.SRGBColorSpace;
      texture.magFilter = three.NearestFilter;
      const plate = new three.Mesh(
        new three.PlaneGeometry(...floor.size),
        new three.MeshBasicMaterial({ map: texture, transparent: true, side: three.DoubleSide }),
      );
      plate.position.set(floor.corner[0] + floor.size[0] / 2, floor.corner[1] + floor.size[1] / 2, floor.z - below);
      group.add(plate);
      scene.add(group);
      floors.set(floor.number, group);
    }

    // What the cameras saw, as squares that face the viewer; above the cut they are left out.
    const clouds = [];
    const addCloud = async ({ spacing, origin, counts, numbers }) => {
      const read = new Uint16Array(await unpacked(numbers).arrayBuffer());
      const total = read.length / 4;
      const positions = new Float32Array(3 * total);
      for (let axis = 0; axis < 3; axis += 1) {
        let at = 0;
        for (let n = 0; n < total; n += 1) {
          at = ((at + read[axis * total + n]) << 16) >> 16;
          positions[3 * n + axis] = (at + 0.5) * spacing + origin[axis];
        }
      }
      const colors = new Uint8Array(3 * total);
      for (let n = 0; n < total; n += 1) {
        const packed = read[3 * total + n];
        colors.set([((packed >> 11) * 255) / 31, (((packed >> 5) & 63) * 255) / 63, ((packed & 31) * 255) / 31], 3 * n);
      }
      let first = 0;
      for (const [number, count] of Object.entries(counts)) {
        const group = floors.get(Number(number));
        const geometry = new three.BufferGeometry();
        geometry.setAttribute("position", new three.BufferAttribute(positions.subarray(3 * first, 3 * (first + count)), 3));
        geometry.setAttribute("color", new three.BufferAttribute(colors.subarray(3 * first, 3 * (first + count)), 3, true));
        first += count;
        if (!group) continue;
        const material = new three.ShaderMaterial({
          uniforms: { cut: { value: 0 }, side: { value: 1.35 * spacing }, pixels: { value: 1 } },
          vertexShader: `
            attribute vec3 color; uniform float cut, side, pixels; varying vec3 shade;
            void main() {
              shade = color;
              vec4 at = modelViewMatrix * vec4(position, 1.0);
              gl_Position = position.z > cut ? vec4(2.0, 2.0, 2.0, 1.0) : projectionMatrix * at;
              gl_PointSize = max(side * pixels / -at.z, 1.0);
            }`,
          fragmentShader: "varying vec3 shade; void main() { gl_FragColor = vec4(shade, 1.0); }",
        });
        const points = new three.Points(geometry, material);
        points.raycast = () => {};
        clouds.push({ material, floor: group.userData });
        group.add(points);
      }
    };

    const told = []; // what has words for the pointer
    const tell = (object, floor, sentence, row = "") => {
      object.userData = { sentence, row };
      told.push(object);
      floors.get(floor)?.add(object);
    };
    for (const { floor, color: name, points } of content.paths) {
      const curve = new three.CurvePath();
      const corners = points.map(([x, y, z]) => new three.Vector3(x, y, z + 0.12));
      for (let n = 1; n < corners.length; n += 1) curve.add(new three.LineCurve3(corners[n - 1], corners[n]));
      const tube = new three.TubeGeometry(curve, Math.min(3 * points.length, 600), 0.045, 6);
      floors.get(floor)?.add(new three.Mesh(tube, ink(name)));
    }
    for (const { floor, z, color: name, words: sentence, rings } of content.marks) {
      const shapes = rings.filter((ring) => ring.length > 2).map((ring) => new three.Shape(ring.map(([x, y]) => new three.Vector2(x, y))));
      const area = new three.Mesh(new three.ExtrudeGeometry(shapes, { depth: 0.25, bevelEnabled: false }), ink(name));
      area.material.transparent = true;
      area.material.opacity = 0.75;
      area.position.z = z;
      tell(area, floor, sentence);
    }
    const outline = (geometry, name) => new three.LineSegments(new three.EdgesGeometry(geometry), new three.LineBasicMaterial({ color: color(name) }));
    const resting = content.isQuiet ? 0 : 0.22; // how much is to be seen of a box that nobody chose
    const boxes = [];
    for (const { floor, low, high, color: name, words: sentence, row } of content.boxes) {
      const geometry = new three.BoxGeometry(...high.map((top, axis) => Math.max(top - low[axis], 0.05)));
      const box = new three.Mesh(geometry, ink(name));
      box.material.transparent = true;
      box.material.opacity = resting;
      box.material.depthWrite = false;
      box.position.set(...high.map((top, axis) => (top + low[axis]) / 2));
      box.add(outline(geometry, name));
      box.children[0].visible = resting > 0;
      boxes.push(box);
      tell(box, floor, sentence, row);
    }
    const frame = (corners, name) => {
      const [eye, ...image] = corners.map((point) => new three.Vector3(...point));
      const lines = image.flatMap((corner, n) => [eye, corner, corner, image[(n + 1) % 4]]);
      return new three.LineSegments(new three.BufferGeometry().setFromPoints(lines), new three.LineBasicMaterial({ color: color(name) }));
    };
    const pictures = [];
    for (const { floor, corners, image, words: sentence } of content.views) {
      const geometry = new three.BufferGeometry().setFromPoints([1, 2, 3, 1, 3, 4].map((n) => new three.Vector3(...corners[n])));
      geometry.setAttribute("uv", new three.Float32BufferAttribute([0, 1, 1, 1, 1, 0, 0, 1, 1, 0, 0, 0], 2));
      const texture = new three.TextureLoader().load(document.getElementById(image).src, () => draw());
      texture.colorSpace = three.SRGBColorSpace;
      const picture = new three.Mesh(geometry, new three.MeshBasicMaterial({ map: texture, side: three.DoubleSide }));
      picture.add(frame(corners, "--robot"));
      picture.visible = false;
      pictures.push(picture);
      tell(picture, floor, sentence);
    }

    // The robot, as an arrow of a metre's height at the step that the page shows.
    const arrow = new three.Shape([[0.45, 0], [-0.35, 0.3], [-0.17, 0], [-0.35, -0.3]].map(([x, y]) => new three.Vector2(x, y)));
    const robot = new three.Mesh(new three.ExtrudeGeometry(arrow, { depth: 0.3, bevelEnabled: false }), ink("--robot"));
    if (content.eye?.length) robot.add(frame(content.eye, "--robot"));
    const stand = (step) => {
      const here = robots[step];
      robot.visible = Boolean(here);
      if (!here) return;
      const [floor, x, y, z, yaw] = here;
      floors.get(floor).add(robot);
      robot.position.set(x, y, z);
      robot.rotation.z = yaw;
      draw();
    };

    const controls = new OrbitControls(camera, renderer.domElement);
    controls.enableZoom = false; // until it is clicked the wheel scrolls the page
    controls.maxPolarAngle = 0.95 * Math.PI;
    const middle = new three.Vector3();
    let reach = 10;
    let asked = false;
    const draw = () => {
      if (!asked) requestAnimationFrame(paint);
      asked = true;
    };
    const paint = () => {
      asked = false;
      const pixels = renderer.domElement.height / (2 * Math.tan((camera.fov * Math.PI) / 360));
      const cut = Number(document.getElementById("cut")?.value ?? 0);
      for (const { material, floor } of clouds) {
        material.uniforms.cut.value = floor.z + cut;
        material.uniforms.pixels.value = pixels;
      }
      renderer.render(scene, camera);
      for (const group of floors.values()) {
        const { label, corner, size, z } = group.userData;
        const at = new three.Vector3(corner[0] + size[0] / 2, corner[1], z + group.position.z).project(camera);
        label.hidden = !group.visible || floors.size < 2 || Math.abs(at.x) > 1 || Math.abs(at.y) > 1;
        label.style.transform = `translate(${((at.x + 1) / 2) * stage.clientWidth}px, ${((1 - at.y) / 2) * stage.clientHeight}px) translate(-50%, 20%)`;
      }
    };
    const arrange = () => {
      const apart = Number(document.getElementById("apart")?.value ?? 0);
      for (const group of floors.values()) group.position.z = apart * group.userData.rank;
      draw();
    };
    const look = (from) => {
      const box = new three.Box3();
      for (const group of floors.values()) {
        if (!group.visible) continue;
        const { corner, size, z } = group.userData;
        const height = z + group.position.z;
        box.expandByPoint(new three.Vector3(...corner, height)).expandByPoint(new three.Vector3(corner[0] + size[0], corner[1] + size[1], height + 1.5));
      }
      box.getCenter(middle);
      reach = box.getSize(new three.Vector3()).length() / 2 / Math.sin((Math.min(camera.fov, camera.fov * camera.aspect) * Math.PI) / 360);
      controls.target.copy(middle);
      const direction = from === "above" ? new three.Vector3(0, -0.01, 1) : new three.Vector3(-0.35, -0.85, 0.75);
      camera.position.copy(middle).addScaledVector(direction.normalize(), 0.72 * reach);
      controls.update();
      draw();
    };
    const zoom = (factor) => {
      camera.position.sub(controls.target).multiplyScalar(factor).add(controls.target);
      controls.update();
      draw();
    };
    const turn = (across, up) => {
      const away = new three.Spherical();
      const off = camera.position.clone().sub(controls.target);
      const upright = new three.Quaternion().setFromUnitVectors(camera.up, new three.Vector3(0, 1, 0));
      away.setFromVector3(off.applyQuaternion(upright));
      away.theta += across;
      away.phi += up;
      away.makeSafe();
      camera.position.setFromSpherical(away).applyQuaternion(upright.invert()).add(controls.target);
      controls.update();
      draw();
    };

    controls.addEventListener("change", draw);
    document.getElementById("pictures")?.addEventListener("change", ({ target }) => {
      for (const picture of pictures) picture.visible = target.checked;
      draw();
    });
    for (const id of ["cut", "apart"]) document.getElementById(id)?.addEventListener("input", arrange);
    for (const button of space.querySelectorAll("[data-look]")) button.addEventListener("click", () => look(button.dataset.look));
    for (const button of space.querySelectorAll("[data-zoom]")) button.addEventListener("click", () => zoom(Number(button.dataset.zoom)));
    const shows = [...space.querySelectorAll("[data-show]")];
    for (const button of shows) {
      button.addEventListener("click", () => {
        for (const other of shows) other.setAttribute("aria-pressed", String(other === button));
        for (const [number, group] of floors) group.visible = button.dataset.show === "all" || Number(button.dataset.show) === number;
        look();
      });
    }
    const turns = { ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] };
    stage.addEventListener("keydown", (event) => {
      if (!Object.hasOwn(turns, event.key) || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      turn(...turns[event.key]);
    });
    stage.addEventListener("focus", () => { controls.enableZoom = true; });
    stage.addEventListener("blur", () => { controls.enableZoom = false; });
    stage.addEventListener("pointerdown", () => stage.focus({ preventScroll: true }));

    // The words of what is under the pointer; a click chooses it on the page.
    const tip = document.createElement("span");
    tip.className = "tip";
    tip.hidden = true;
    stage.append(tip);
    const ray = new three.Raycaster();
    const under = (event) => {
      const { left, top, width, height } = stage.getBoundingClientRect();
      const at = new three.Vector2((2 * (event.clientX - left)) / width - 1, 1 - (2 * (event.clientY - top)) / height);
      ray.setFromCamera(at, camera);
      const hit = ray.intersectObjects(told.filter((one) => one.visible && one.parent?.visible), false)[0];
      tip.hidden = !hit;
      if (!hit) return null;
      tip.textContent = hit.object.userData.sentence;
      tip.style.transform = `translate(${event.clientX - left + 12}px, ${event.clientY - top + 12}px)`;
      return hit.object;
    };
    stage.addEventListener("pointermove", under);
    stage.addEventListener("pointerleave", () => { tip.hidden = true; });
    stage.addEventListener("click", (event) => {
      const row = under(event)?.userData.row;
      if (row) document.dispatchEvent(new CustomEvent("chosen-in-space", { detail: row }));
    });
    document.addEventListener("chosen-on-page", ({ detail }) => {
      for (const box of boxes) {
        const isChosen = box.userData.row === detail;
        box.material.opacity = isChosen ? 0.7 : resting;
        box.children[0].visible = isChosen || resting > 0;
      }
      draw();
    });
    document.addEventListener("step-shown", ({ detail }) => stand(detail));

    stage.prepend(renderer.domElement);
    if (content.cloud) await addCloud(content.cloud);
    arrange();
    let isFirst = true;
    new ResizeObserver(() => {
      renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
      renderer.setSize(stage.clientWidth, stage.clientHeight);
      camera.aspect = stage.clientWidth / Math.max(stage.clientHeight, 1);
      camera.updateProjectionMatrix();
      if (isFirst) look();
      isFirst = false;
      draw();
    }).observe(stage);
    stand(Object.keys(robots).at(-1));
    space.dataset.state = "drawn";
  };

  // Nothing is unpacked before somebody comes near.
  const watcher = new IntersectionObserver((entries) => {
    if (!entries.some((entry) => entry.isIntersecting)) return;
    watcher.disconnect();
    begin().catch((error) => {
      space.dataset.state = "failed";
      words.textContent = `This browser can’t draw the building in three dimensions (${error.message}).`;
      stage.remove();
    });
  }, { rootMargin: "300px" });
  watcher.observe(stage);
})();
