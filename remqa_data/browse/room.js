"use strict";
// A room in three dimensions: turned by hand, and what opens is opened. The model is a script of its own (MODEL), so that it also
// loads from disk; names and joints stand in its nodes' extras.
(() => {
  const byId = (id) => document.getElementById(id);
  const canvas = byId("room"), state = byId("state");
  const fail = (text) => { state.textContent = text; state.classList.add("bad"); };
  if (typeof MODEL === "undefined" || MODEL === null) return fail("The stored room cannot be read: the dataset is damaged.");

  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
  } catch {
    return fail("This browser shows no 3D: WebGL is switched off.");
  }
  renderer.toneMapping = THREE.NeutralToneMapping;
  renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
  const scene = new THREE.Scene(), camera = new THREE.PerspectiveCamera(45, 1, 0.05, 100);
  const controls = new THREE.OrbitControls(camera, canvas);
  scene.add(new THREE.HemisphereLight(0xffffff, 0xb8b0a4, 2.2));
  const sun = new THREE.DirectionalLight(0xfff4e2, 1.6);
  sun.position.set(2, 5, 3);
  scene.add(sun);

  // ---- what is drawn, only when something has changed
  let isAsked = false;
  const moving = new Map(), walls = [];
  const draw = (now) => {
    isAsked = false;
    for (const [openable, from] of moving) {
      const share = Math.min((now - from.time) / 450, 1), eased = share * share * (3 - 2 * share);
      openable.set(from.share + (openable.wanted - from.share) * eased);
      if (share === 1) moving.delete(openable);
    }
    for (const { node, axis, middle, side } of walls) node.visible = (camera.position[axis] - middle) * side > 0;
    renderer.render(scene, camera);
    byId("stage").dataset.moving = moving.size;
    if (moving.size) ask();
  };
  const ask = () => { if (!isAsked) { isAsked = true; requestAnimationFrame(draw); } };
  controls.addEventListener("change", ask);
  const fit = () => {
    const { clientWidth: width, clientHeight: height } = byId("stage");
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    ask();
  };
  new ResizeObserver(fit).observe(byId("stage"));

  // ---- what opens
  class Openable {
    constructor(id, links, taken) {
      Object.assign(this, { id, links, taken, share: 0, wanted: 0 });
      this.closed = links.map((link) => ({
        link,
        position: link.position.clone(),
        quaternion: link.quaternion.clone(),
        axis: new THREE.Vector3(...link.userData.axis),
      }));
      const [{ userData }] = links;
      this.share = this.wanted = userData.range[1] > 0 ? Math.min(userData.position / userData.range[1], 1) : 0;
      this.rests = taken.map((node) => node.position.clone());
      this.start = this.share;
    }
    set(share) {
      this.share = share;
      for (const { link, position, quaternion, axis } of this.closed) {
        const change = link.userData.range[1] * share - link.userData.position;
        if (link.userData.joint === "prismatic") link.position.copy(position).addScaledVector(axis, change);
        else link.quaternion.setFromAxisAngle(axis, change).multiply(quaternion);
      }
      const [{ link, axis }] = this.closed;
      if (link.userData.joint !== "prismatic") return;
      const way = axis.clone().transformDirection(link.parent.matrix);
      for (const [place, node] of this.taken.entries()) {
        node.position.copy(this.rests[place]).addScaledVector(way, link.userData.range[1] * (share - this.start));
      }
    }
    toggle(isOpen = this.wanted < 0.5) {
      moving.set(this, { time: performance.now(), share: this.share });
      this.wanted = isOpen ? 1 : 0;
      this.button.setAttribute("aria-pressed", isOpen);
      sayAll();
      ask();
    }
  }
  const openables = new Map(), all = byId("all");
  const sayAll = () => {
    const isOpen = [...openables.values()].every((openable) => openable.wanted >= 0.5);
    all.setAttribute("aria-pressed", isOpen);
    all.textContent = isOpen ? "Close all" : "Open all";
  };
  const list = (root) => {
    const carried = JSON.parse(byId("carried").textContent), nodes = new Map();
    root.traverse((node) => { if (node.userData.name) nodes.set(node.userData.name, node); });
    root.traverse((node) => {
      if (!node.userData.type) return;
      const links = [];
      node.traverse((below) => { if (below.userData.joint && below.userData.range[1] !== 0) links.push(below); });
      if (!links.length) return;
      const id = node.userData.name;
      const taken = (carried[id] || []).map((name) => nodes.get(name)).filter(Boolean);
      openables.set(id, new Openable(id, links, taken));
    });
    for (const [id, openable] of [...openables].sort(([a], [b]) => a.localeCompare(b))) {
      openable.button = Object.assign(document.createElement("button"), { type: "button", textContent: id });
      openable.button.setAttribute("aria-pressed", openable.wanted > 0.5);
      openable.button.addEventListener("click", () => openable.toggle());
      byId("openable").append(document.createElement("li"));
      byId("openable").lastChild.append(openable.button);
    }
    byId("count").textContent = openables.size;
    all.disabled = !openables.size;
    if (openables.size) sayAll();
    all.addEventListener("click", () => {
      const isOpen = all.getAttribute("aria-pressed") !== "true";
      for (const openable of openables.values()) openable.toggle(isOpen);
    });
  };

  // ---- what is under the pointer
  const caster = new THREE.Raycaster();
  const pointedAt = (event) => {
    const { left, top, width, height } = canvas.getBoundingClientRect();
    const at = new THREE.Vector2((event.clientX - left) / width * 2 - 1, 1 - (event.clientY - top) / height * 2);
    caster.setFromCamera(at, camera);
    for (const { object } of caster.intersectObjects(scene.children, true)) {
      for (let node = object; node; node = node.parent) {
        if (!node.visible) break;
        if (node.userData.type) return node.userData.name;
      }
    }
    return null;
  };
  let pressed = null;
  canvas.addEventListener("pointerdown", (event) => { pressed = [event.clientX, event.clientY]; });
  canvas.addEventListener("pointermove", (event) => {
    const id = event.buttons ? null : pointedAt(event);
    byId("pointed").textContent = id ?? "";
    canvas.style.cursor = openables.has(id) ? "pointer" : "grab";
  });
  canvas.addEventListener("click", (event) => {
    const isDragged = pressed && Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 4;
    if (!isDragged) openables.get(pointedAt(event))?.toggle();
  });
  canvas.addEventListener("keydown", (event) => {
    const turns = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const offset = camera.position.clone().sub(controls.target);
    if (event.key === "+" || event.key === "-") offset.multiplyScalar(event.key === "+" ? 0.9 : 1.1);
    else if (event.key in turns) {
      const [along, down] = turns[event.key];
      offset.applyAxisAngle(new THREE.Vector3(0, 1, 0), along * 0.15);
      const side = new THREE.Vector3(0, 1, 0).cross(offset).normalize();
      const turned = offset.clone().applyAxisAngle(side, down * 0.12);
      const lean = turned.angleTo(new THREE.Vector3(0, 1, 0));
      if (lean > 0.05 && lean < 1.55) offset.copy(turned);
    } else return;
    event.preventDefault();
    camera.position.copy(controls.target).add(offset);
    controls.update();
    ask();
  });

  // ---- the model
  const bytes = Uint8Array.from(atob(MODEL), (letter) => letter.charCodeAt(0));
  new THREE.GLTFLoader().parse(bytes.buffer, "", ({ scene: root }) => {
    scene.add(root);
    root.updateMatrixWorld(true);
    const inside = new THREE.Box3(), built = [];
    root.traverse((node) => {
      const [what, kind] = (node.userData.name ?? "").split("/");
      if (what !== "structure") return;
      if (kind === "ceiling" || kind === "outside") node.visible = false;
      else if (kind === "wall") built.push(node);
      if (kind !== "outside") inside.expandByObject(node);
    });
    if (inside.isEmpty()) inside.setFromObject(root);
    else { // floors are recorded as slabs that run on under the walls
      const { min, max } = inside, slack = 0.02;
      const planes = [[1, 0, 0, -min.x], [-1, 0, 0, max.x], [0, 1, 0, -min.y], [0, 0, 1, -min.z], [0, 0, -1, max.z]];
      renderer.clippingPlanes = planes.map(([x, y, z, far]) => ({ normal: new THREE.Vector3(x, y, z), constant: far + slack }));
    }
    const { center, radius } = inside.getBoundingSphere(new THREE.Sphere());
    for (const node of built) { // walls are seen from the room's side alone
      const box = new THREE.Box3().setFromObject(node), size = box.getSize(new THREE.Vector3());
      const axis = size.x < size.z ? "x" : "z", middle = box.getCenter(new THREE.Vector3())[axis];
      walls.push({ node, axis, middle, side: Math.sign(center[axis] - middle) || 1 });
    }
    const hung = new Set(JSON.parse(byId("hung").textContent)), plain = [...walls];
    root.traverse((node) => { // and so is what hangs on them
      if (!hung.has(node.userData.name)) return;
      const at = new THREE.Box3().setFromObject(node).getCenter(new THREE.Vector3());
      const off = ({ axis, middle }) => Math.abs(at[axis] - middle);
      const wall = plain.filter((other) => off(other) < 0.5).sort((a, b) => off(a) - off(b))[0];
      if (wall) walls.push({ ...wall, node });
    });
    controls.target.set(center.x, 0.6, center.z);
    fit();
    const half = Math.atan(Math.tan(camera.fov * Math.PI / 360) * Math.min(1, camera.aspect));
    const from = new THREE.Vector3(0.85, 1.45, 1.45).setLength(0.97 * radius / Math.sin(half));
    camera.position.copy(controls.target).add(from);
    Object.assign(controls, { maxPolarAngle: Math.PI / 2 - 0.02, minDistance: 0.4, maxDistance: radius * 5 });
    controls.update();
    list(root);
    state.hidden = true;
    document.body.dataset.loaded = openables.size;
    ask();
  }, () => fail("The model of the room cannot be read."));
})();
