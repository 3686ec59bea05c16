// The ROS graph. Python says what is there and where it goes; here it is drawn, and what is asked about is shown.

const SMALLEST_SCALE = 0.85; // below which a graph is scrolled and not made smaller
const ASK_PERIOD = 2000; // ms; Python measures a rate for as long as it is asked for
const PATIENCE = 250; // ms that the mouse rests on something before its rate is asked for
const CORNER = 10; // px, of a topic's hexagon
const HINT = "Point at a node, a topic or an arrow, or reach it with Tab and the arrow keys: type, rate and QoS are shown here.";

export default () => {
  const seenBy = audience();
  let isSaved = false;

  function initialize({ model }) {
    isSaved = Boolean(model.get("saved"));
    // Read when JupyterLab saves the notebook; Python knows nothing of it.
    if (isSaved) seenBy.beAlone();
    else model.set("saved", true);
  }

  function render({ model, el }) {
    el.classList.add("ros2lab-card", "ros2lab-graph");
    el.innerHTML = `
      <div class="ros2lab-head"><span class="ros2lab-title">ROS graph</span><span class="ros2lab-news"></span>
        <label><input type="checkbox" data-trait="services"> services</label>
        <label title="also what every node has, and what is hidden"><input type="checkbox" data-trait="everything"> all</label></div>
      <div class="ros2lab-scroll"><svg role="group" data-lm-suppress-shortcuts="true"><g></g><g></g></svg></div>
      <div class="ros2lab-details"></div>
      <ul class="ros2lab-faults" aria-live="polite" aria-label="What does not fit"></ul>
      <ul class="ros2lab-notes" aria-label="What is one-sided"></ul>`;
    const [news, scroll, svg, details, faults, notes] =
      [".ros2lab-news", ".ros2lab-scroll", "svg", ".ros2lab-details", ".ros2lab-faults", ".ros2lab-notes"]
        .map((selector) => el.querySelector(selector));
    const toggles = [...el.querySelectorAll("input")];
    const drawn = new Map(); // id -> its <g>
    const screen = onScreen(model, el, seenBy, draw, () => !isSaved && asked() && ask());
    let scene = null, width = 0;
    let focused = null, hovered = null, tabStop = null, timer = null;
    const asked = () => hovered ?? focused;

    function draw() {
      if (!scroll.clientWidth) return; // its size is yet to come
      scene = model.get("scene");
      // Only what comes and goes in the graph moves its boxes slowly.
      svg.classList.toggle("ros2lab-at-once", scroll.clientWidth !== width);
      width = scroll.clientWidth;
      news.textContent = scene.summary + (isSaved ? ", as it was when its kernel ended" : "");
      const layout = fitting(scene.layouts, width);
      const scale = Math.min(1, Math.max(SMALLEST_SCALE, width / layout.width));
      svg.setAttribute("viewBox", `0 0 ${layout.width} ${layout.height}`);
      svg.setAttribute("width", layout.width * scale);
      svg.setAttribute("height", layout.height * scale);
      svg.setAttribute("aria-label", `ROS graph with ${scene.summary}`);
      el.classList.toggle("ros2lab-empty", !scene.boxes.length);
      const parts = [...scene.arrows, ...scene.boxes];
      const ids = new Set(parts.map((part) => part.id));
      for (const [id, group] of drawn) if (!ids.has(id)) drawn.delete(id), group.remove();
      for (const part of parts) place(part, layout);
      if (!ids.has(tabStop)) tabStop = scene.boxes[0]?.id ?? null;
      if (!ids.has(focused)) focused = null;
      if (!ids.has(hovered)) hovered = null;
      for (const [id, group] of drawn) group.setAttribute("tabindex", id === tabStop ? 0 : -1);
      list(faults, scene.faults.map((said) => [said.text, said.kind]));
      list(notes, scene.notes.map((text) => [text, ""]));
      describe();
    }

    function place(part, layout) {
      let group = drawn.get(part.id);
      if (!group) {
        group = document.createElementNS("http://www.w3.org/2000/svg", "g");
        group.dataset.id = part.id;
        group.dataset.kind = part.kind;
        group.setAttribute("role", "img");
        listen(group, part.id);
        drawn.set(part.id, group);
        svg.children[part.kind in BOXES ? 1 : 0].append(group); // boxes lie on top of arrows
      }
      group.setAttribute("class", `ros2lab-part ros2lab-${part.kind} ${part.fault ? `ros2lab-fault ros2lab-${part.fault}` : ""} ${part.note ? "ros2lab-lone" : ""}`);
      group.setAttribute("aria-label", part.words);
      const isBox = part.kind in BOXES;
      const content = isBox ? box(part) : arrow(part, layout.curves[part.id], layout.middles[part.id]);
      if (group.dataset.content !== content) {
        group.dataset.content = content;
        group.innerHTML = content;
      }
      if (isBox) group.style.transform = `translate(${layout.boxes[part.id].map((length) => `${length}px`).join(",")})`;
    }

    function listen(group, id) {
      group.addEventListener("pointerenter", () => { hovered = id; describe(); });
      group.addEventListener("pointerleave", () => { if (hovered === id) hovered = null; describe(); });
      group.addEventListener("focus", () => { focused = id; hovered = null; stopAt(id); describe(); });
      group.addEventListener("blur", () => { if (focused === id) focused = null; describe(); });
    }

    function stopAt(id) {
      drawn.get(tabStop)?.setAttribute("tabindex", -1);
      tabStop = id;
      drawn.get(id)?.setAttribute("tabindex", 0);
    }

    svg.addEventListener("keydown", (event) => {
      const ids = inReadingOrder(scene);
      const at = ids.indexOf(focused);
      const next = { ArrowRight: at + 1, ArrowDown: at + 1, ArrowLeft: at - 1, ArrowUp: at - 1, Home: 0, End: ids.length - 1 }[event.key];
      if (event.key === "Escape") drawn.get(focused)?.blur();
      else if (next === undefined || at < 0) return;
      else drawn.get(ids[Math.min(Math.max(next, 0), ids.length - 1)])?.focus();
      event.preventDefault();
      event.stopPropagation();
    });

    let askedBefore = null;
    function describe() {
      const part = scene && [...scene.boxes, ...scene.arrows].find((candidate) => candidate.id === asked());
      const near = part ? neighbours(scene, part.id) : null;
      svg.classList.toggle("ros2lab-asking", Boolean(part));
      for (const [id, group] of drawn) group.classList.toggle("ros2lab-near", near?.has(id) ?? false);
      const content = part ? about(part, isSaved ? {} : model.get("rates"), isSaved) : `<p class="ros2lab-note">${HINT}</p>`;
      if (details.dataset.content !== content) {
        details.dataset.content = content;
        details.innerHTML = content;
      }
      for (const item of faults.children) item.classList.toggle("ros2lab-told", Boolean(part?.faults.includes(item.textContent)));
      if (part?.id === askedBefore) return;
      askedBefore = part?.id ?? null;
      clearTimeout(timer);
      if (!isSaved) timer = setTimeout(ask, PATIENCE);
    }

    // Also when nothing is asked about any more, so that Python unsubscribes; then there is no next time.
    function ask() {
      const part = scene && screen.isSeen() ? [...scene.boxes, ...scene.arrows].find((candidate) => candidate.id === asked()) : undefined;
      model.send({ measure: part ? part.topics : [] });
      clearTimeout(timer);
      if (part?.topics.length) timer = setTimeout(ask, ASK_PERIOD);
    }

    const showToggles = () => {
      for (const input of toggles) [input.checked, input.disabled] = [model.get(input.dataset.trait), isSaved];
    };
    for (const input of toggles) {
      input.addEventListener("change", () => {
        model.set(input.dataset.trait, input.checked);
        model.save_changes();
      });
      model.on(`change:${input.dataset.trait}`, showToggles);
    }
    const change = () => screen.ask();
    model.on("change:scene", change);
    model.on("change:rates", describe);
    const resized = new ResizeObserver(() => scroll.clientWidth !== width && screen.ask());
    resized.observe(scroll);
    showToggles();
    return () => {
      clearTimeout(timer);
      if (askedBefore !== null && !isSaved) model.send({ measure: [] });
      screen.end();
      resized.disconnect();
      model.off("change:scene", change);
      model.off("change:rates", describe);
    };
  }

  return { initialize, render };
};

// The first layout that fits, and the narrowest if none does.
function fitting(layouts, width) {
  return layouts.find((layout) => layout.width * SMALLEST_SCALE <= width)
    ?? layouts.reduce((one, other) => (other.width < one.width ? other : one));
}

const BOXES = { node: roundedBox(6), topic: hexagon, service: roundedBox(null) };

function box(part) {
  const badgeAt = [part.width / 2 - 4, -part.height / 2 - 2];
  return `${BOXES[part.kind](part.width, part.height)}
    <text class="ros2lab-label" y="${part.note ? -3 : 4}">${escaped(part.label)}</text>
    ${part.note ? `<text class="ros2lab-second" y="12">${escaped(part.note)}</text>` : ""}
    ${badge(part.badge, badgeAt)}`;
}

function roundedBox(radius) {
  return (width, height) =>
    `<rect class="ros2lab-shape" x="${-width / 2}" y="${-height / 2}" width="${width}" height="${height}" rx="${radius ?? height / 2}"/>`;
}

function hexagon(width, height) {
  const [x, y] = [width / 2, height / 2];
  return `<path class="ros2lab-shape" d="M${-x} 0L${CORNER - x} ${-y}H${x - CORNER}L${x} 0L${x - CORNER} ${y}H${CORNER - x}Z"/>`;
}

function arrow(part, curve, middle) {
  const points = curve.slice(0, -1), tip = curve.at(-1), base = points.at(-1);
  const path = `M${points[0]}C${points.slice(1).join(" ")}${part.kind === "link" ? `L${tip}` : ""}`;
  const length = Math.hypot(tip[0] - base[0], tip[1] - base[1]) || 1;
  const side = [-(tip[1] - base[1]) / length * 3.5, (tip[0] - base[0]) / length * 3.5];
  const head = `M${base[0] + side[0]} ${base[1] + side[1]}L${tip}L${base[0] - side[0]} ${base[1] - side[1]}Z`;
  return `<path class="ros2lab-reach" d="${path}"/><path class="ros2lab-line" d="${path}"/>
    ${part.kind === "link" ? "" : `<path class="ros2lab-tip" d="${head}"/>`}${badge(part.badge, middle)}`;
}

function badge(text, [x, y]) {
  if (!text) return "";
  const width = 6.4 * text.length + 10;
  return `<g class="ros2lab-badge" transform="translate(${x} ${y})"><rect x="${-width / 2}" y="-8" width="${width}" height="16" rx="8"/>
    <text y="3.5">${escaped(text)}</text></g>`;
}

// A part, what it touches, and, of an arrow, both ends.
function neighbours(scene, id) {
  const near = new Set([id]);
  for (const line of scene.arrows) {
    if (line.id === id) near.add(line.source).add(line.target);
    if (line.source === id || line.target === id) near.add(line.id).add(line.source).add(line.target);
  }
  return near;
}

// Each box, followed by the arrows that leave it.
function inReadingOrder(scene) {
  const { boxes: places, direction } = scene.layouts.at(-1);
  const along = direction === "LR" ? 0 : 1;
  const sorted = [...scene.boxes].sort((one, other) =>
    places[one.id][along] - places[other.id][along] || places[one.id][1 - along] - places[other.id][1 - along]);
  return sorted.flatMap((part) => [part.id, ...scene.arrows.filter((line) => line.source === part.id).map((line) => line.id)]);
}

function about(part, rates, isSaved) {
  const types = [...new Set(part.rows.map((row) => row.type))];
  const isOfOneType = types.length === 1 && part.kind !== "node";
  const rate = (topic) => (isSaved ? "" : rates[topic] ?? "measuring …");
  const head = `<b>${escaped(part.title)}</b> <span class="ros2lab-kind">${part.kind in BOXES ? part.kind : ""}</span>
    ${isOfOneType ? `<code>${escaped(types[0])}</code>` : ""}
    ${part.kind !== "node" && part.topics.length ? `<span class="ros2lab-rate" role="status">${escaped(rate(part.topics[0]))}</span>` : ""}`;
  const cells = (row) => [row.what, row.role, ...(isOfOneType ? [] : [row.type]), row.qos,
    ...(part.kind === "node" ? [part.topics.includes(row.what) ? rate(row.what) : ""] : [])];
  const rows = part.rows.map((row) => `<tr>${cells(row).map((cell) => `<td>${escaped(cell)}</td>`).join("")}</tr>`);
  return `<div>${head}</div><table>${rows.join("")}</table>`;
}

function list(ul, entries) {
  const content = entries.map(([text, kind]) =>
    `<li class="${kind ? `ros2lab-fault ros2lab-${kind}` : ""}">${kind ? MARK : ""}<span>${escaped(text)}</span></li>`).join("");
  if (ul.dataset.content === content) return;
  ul.dataset.content = content;
  ul.innerHTML = content;
}

const MARK = `<svg width="26" height="10" aria-hidden="true"><path class="ros2lab-line" d="M1 5H25"/></svg>`;

const escaped = (text) => text.replace(/[&<>"]/g, (letter) => `&#${letter.charCodeAt(0)};`);
