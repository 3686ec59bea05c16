// Draws robots on a plane, each with its trail.
// Python integrates the commands; here is kept what is on the screen, and how far somebody has zoomed in.

const SVG = "http://www.w3.org/2000/svg";
const NUMBERS = 5; // a robot: x (m), y (m), heading (rad), linear (m/s), angular (rad/s)
const LEAST_HALF = 2; // m, from the middle of the picture to its edge, at least
const LEAST_RADIUS = 11; // px, of a robot far away
const MOST_KEPT = 20000; // vertices a robot, in the browser
const MOST_SAVED = 2000; // vertices a robot, in a saved notebook
const BODY = 1.25; // radii of the robot, from its middle to the edge of its picture
const COVERED = 0.6; // of the radius: so much of the trail's end lies under the robot, and need not be drawn yet
const DASHES = [[], [8, 3], [3, 3], [10, 3, 3, 3]]; // px, of the trails
const SPOKEN_PERIOD = 2000; // ms between two texts for screen readers
const ZOOM = 1.4;
const RECORDED = 6; // a moment of a recording: time (s), and the numbers of a robot

// Called once a model: its views share the trails, and a new view finds them all.
export default () => {
  const state = { robots: [], isWhole: false, isSaved: false, moment: null };
  const seenBy = audience();

  function initialize({ model }) {
    const begin = ([x, y, heading]) => ({ pose: [x, y, heading, 0, 0], trail: [[x, y]], ahead: [], note: "", isHeard: false });
    if (model.get("span")) {
      state.robots = model.get("moments").map(recorded);
      seenBy.beAlone();
      return;
    }
    const saved = model.get("saved");
    if (saved) {
      // From a notebook whose kernel has gone: it stands still where it was.
      Object.assign(state, { robots: saved.robots, isSaved: true });
      seenBy.beAlone();
      return;
    }
    state.robots = model.get("starts").map(begin);
    // Read when JupyterLab saves the notebook, and not before; Python knows nothing of it.
    model.set("saved", {
      get robots() {
        return state.robots.map(({ pose, note, isHeard, trail, ahead }) => ({ pose, note, isHeard, trail: thinned(trail), ahead }));
      },
    });
    model.on("msg:custom", (message, [buffer]) => {
      const { byteOffset: at, byteLength: length } = buffer;
      const numbers = new Float64Array(buffer.buffer.slice(at, at + length));
      let next = NUMBERS * state.robots.length;
      const points = (count) => Array.from({ length: count }, () => [numbers[next++], numbers[next++]]);
      state.robots.forEach((robot, i) => {
        robot.pose = Array.from(numbers.subarray(NUMBERS * i, NUMBERS * (i + 1)));
        robot.note = message.notes[i];
        robot.isHeard = message.are_heard[i];
        if (message.is_whole) robot.trail = [];
        robot.trail.push(...points(message.vertices[i]));
        if (robot.trail.length > MOST_KEPT) robot.trail = robot.trail.slice(MOST_KEPT / 4);
      });
      // What the next look may take back: a command can become known late.
      state.robots.forEach((robot, i) => (robot.ahead = points(message.ahead[i])));
      if (message.is_whole) state.isWhole = true;
    });
    askFor("trail", model, state);
  }

  function render({ model, el }) {
    const names = model.get("names"), isSaved = state.isSaved, span = model.get("span");
    el.classList.add("ros2lab-card", "ros2lab-robot");
    el.innerHTML = `
      <div class="ros2lab-head"><span class="ros2lab-title">Robot</span> <code></code><span class="ros2lab-news"></span>
        <button type="button" class="jp-mod-styled" data-do="in" title="Zoom in" aria-label="Zoom in">+</button>
        <button type="button" class="jp-mod-styled" data-do="out" title="Zoom out" aria-label="Zoom out">−</button>
        <button type="button" class="jp-mod-styled" data-do="fit" title="Show the whole trail" aria-pressed="true">Fit</button>
        <button type="button" class="jp-mod-styled" data-do="reset" title="Put it back to the start, and forget its trail">Reset</button></div>
      <div class="ros2lab-plane" role="img" tabindex="0" data-lm-suppress-shortcuts="true">
        <svg data-part="grid"></svg><canvas data-part="trails"></canvas><svg data-part="ends"></svg><div data-part="robots"></div></div>
      <div class="ros2lab-readout"></div><div class="ros2lab-note" role="status"></div>`;
    const find = (selector) => el.querySelector(selector);
    const [news, plane, readout, note] = [".ros2lab-news", ".ros2lab-plane", ".ros2lab-readout", ".ros2lab-note"].map(find);
    const [grid, canvas, ends, figures] = ["grid", "trails", "ends", "robots"].map((part) => find(`[data-part=${part}]`));
    const button = (name) => find(`[data-do=${name}]`);
    find("code").textContent = model.get("topic");
    button("reset").disabled = isSaved;
    const drawn = names.map((name, i) => figure(figures, readout, name, i, names.length));
    const trails = trailsOn(canvas, ends, names.length);
    const view = { x: 0, y: 0, half: 0, isFitted: true };
    let size = [0, 0], spokenAt = 0;
    const screen = onScreen(model, el, seenBy, draw);

    function draw(isTextTurn, isNewTheme) {
      if (!size[0]) return;
      if (view.isFitted) fit();
      const radius = Math.max(pixels() * model.get("robot_radius"), LEAST_RADIUS);
      if (isNewTheme) trails.forget();
      trails.show(state.robots, model.get("starts"), size, pixels(), place, COVERED * radius);
      state.robots.forEach((robot, i) => drawn[i].show(robot, place, radius));
      if (isTextTurn) tell();
      else screen.ask({ after: page.untilText(), within: 50 });
    }

    function tell() {
      state.robots.forEach((robot, i) => drawn[i].tell(robot.pose));
      write(news, span ? `recorded: ${model.get("recording")}` : isSaved ? "as it was when its kernel ended" : report(state.robots));
      write(note, state.robots.map((robot) => robot.note).filter(Boolean).join(" "));
      if (performance.now() - spokenAt < SPOKEN_PERIOD) return;
      spokenAt = performance.now();
      const where = state.robots.map((robot, i) => `${names[i]} at ${inWords(robot.pose)}`).join("; ");
      plane.setAttribute("aria-label", `Plane with robot ${where}. Plus and minus zoom, the arrow keys move the picture.`);
    }

    const pixels = () => Math.min(...size) / 2 / view.half;
    const place = ([x, y]) => [size[0] / 2 + (x - view.x) * pixels(), size[1] / 2 - (y - view.y) * pixels()];

    function look() {
      drawGrid(grid, view, size, pixels(), place);
      trails.forget();
      screen.ask();
    }

    // The picture moves only when a robot comes near its edge, and then far enough to stay a while.
    function fit() {
      const [low, high] = bounds(state.robots);
      const [across, up] = size.map((length) => length / Math.min(...size));
      const need = Math.max((high[0] - low[0]) / 2 / across, (high[1] - low[1]) / 2 / up);
      const isInside = [low, high].every((corner) =>
        Math.abs(corner[0] - view.x) < 0.92 * view.half * across && Math.abs(corner[1] - view.y) < 0.92 * view.half * up);
      if (view.half && isInside && need > 0.2 * view.half - LEAST_HALF) return;
      [view.x, view.y, view.half] = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, Math.max(LEAST_HALF, 1.3 * need)];
      look();
    }

    function choose(isFitted) {
      view.isFitted = isFitted;
      if (isFitted) view.half = 0;
      button("fit").setAttribute("aria-pressed", isFitted);
      isFitted ? screen.ask() : look();
    }

    function zoom(factor) {
      view.half = Math.min(1e6, Math.max(0.2, view.half * factor));
      choose(false);
    }

    function shift(across, up) {
      view.x -= across / pixels();
      view.y += up / pixels();
      choose(false);
    }

    const actions = {
      in: () => zoom(1 / ZOOM), out: () => zoom(ZOOM), fit: () => choose(true),
      reset: () => (model.send({ ask: "reset" }), choose(true)),
    };
    for (const [name, act] of Object.entries(actions)) button(name).addEventListener("click", act);
    if (span) button("reset").remove();
    const keys = {
      "+": actions.in, "=": actions.in, "-": actions.out, "0": actions.fit,
      ArrowLeft: () => shift(40, 0), ArrowRight: () => shift(-40, 0), ArrowUp: () => shift(0, 40), ArrowDown: () => shift(0, -40),
    };
    plane.addEventListener("keydown", (event) => {
      if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      event.stopPropagation();
      keys[event.key]();
    });
    plane.addEventListener("pointerdown", (event) => event.button || plane.setPointerCapture(event.pointerId));
    plane.addEventListener("pointermove", (event) =>
      plane.hasPointerCapture(event.pointerId) && shift(event.movementX, event.movementY));

    // After a reset the picture closes in on the robot again.
    const receive = (message) => {
      if (message.is_whole && view.isFitted) view.half = 0;
      screen.ask();
    };
    model.on("msg:custom", receive);
    const resized = new ResizeObserver(() => {
      size = [plane.clientWidth, plane.clientHeight];
      if (size[0] && view.half) look();
      screen.ask();
    });
    resized.observe(plane);
    const leave = span && timeline(el, { name: model.get("recording"), span }, state, (moment) => {
      state.robots.forEach((robot) => putAt(robot, moment));
      screen.ask();
    });
    return () => {
      if (leave) leave();
      screen.end();
      resized.disconnect();
      model.off("msg:custom", receive);
    };
  }

  return { initialize, render };
};

// A robot of a recording; `shown` says how much of its trail it has driven.
function recorded(data) {
  const rows = rowsOf(data, RECORDED), trail = rows.map(([, x, y]) => [x, y]);
  return { rows, trail, shown: rows.length, pose: Array.from(rows.at(-1).slice(1)), ahead: [], note: "", isHeard: true };
}

// Between two moments it drives as good as straight.
function putAt(robot, moment) {
  const i = rowAt(robot.rows, moment), row = robot.rows[i], next = robot.rows[i + 1] ?? row;
  const part = next === row ? 0 : Math.max(0, (moment - row[0]) / (next[0] - row[0]));
  robot.pose = [1, 2, 3].map((column) => row[column] + part * (next[column] - row[column])).concat(row[4], row[5]);
  robot.shown = i + 1;
}

// The trails, and a cross where each began. Vertices that are drawn stay, and only new ones are added. The way from the
// last one to the robot lies over them, for it may still change. Both wait until the robot no longer covers what is new:
// to move a robot the browser need not paint anything.
function trailsOn(canvas, ends, count) {
  const paths = Array.from({ length: count }, (_, i) => {
    const path = ends.appendChild(document.createElementNS(SVG, "path"));
    path.setAttribute("class", `ros2lab-robot-${i}`);
    return path;
  });
  const driven = (robot) => robot.shown ?? robot.trail.length;
  let drawn = null; // of each robot: its trail, how many of its vertices, the last one and how far it is (px), the end (px)
  let pen = null;

  function begin(robots, starts, [width, height], scale, place) {
    pen = cleared(canvas, width, height);
    pen.lineJoin = "round";
    pen.strokeStyle = getComputedStyle(canvas).getPropertyValue("--faint");
    pen.lineWidth = 1.5;
    for (const start of starts) {
      const [x, y] = place(start), arm = 0.15 * scale;
      pen.stroke(new Path2D(`M${x - arm} ${y}h${2 * arm}M${x} ${y - arm}v${2 * arm}`));
    }
    drawn = robots.map(({ trail, pose }) => ({ first: trail[0], count: 1, last: place(trail[0] ?? pose), length: 0, end: null }));
    pen.globalAlpha = 0.5;
    robots.forEach(({ rows, trail }, i) => rows && strokeThrough(trail.map(place), i, 1.2));
    pen.globalAlpha = 1;
  }

  function strokeThrough(points, i, width) {
    pen.strokeStyle = getComputedStyle(paths[i]).getPropertyValue("--robot");
    pen.lineWidth = width;
    pen.setLineDash(DASHES[i]);
    pen.lineDashOffset = drawn[i].length;
    pen.lineCap = DASHES[i].length ? "butt" : "round";
    pen.beginPath();
    for (const point of points) pen.lineTo(...point);
    pen.stroke();
  }

  function extend(robot, i, place) {
    const part = drawn[i], points = [part.last, ...robot.trail.slice(part.count, driven(robot)).map(place)];
    if (points.length > 1) strokeThrough(points, i, 2.5);
    for (const next of points) {
      part.length += distance(part.last, next);
      part.last = next;
    }
    part.count = Math.max(1, driven(robot));
    part.end = place(robot.pose);
    paths[i].setAttribute("d", `M${[part.last, ...robot.ahead.map(place), part.end].join("L")}`);
    paths[i].style.strokeDashoffset = part.length;
  }

  return {
    forget: () => (drawn = null),
    show(robots, starts, size, scale, place, covered) {
      const isAnother = (robot, i) => robot.trail[0] !== drawn[i].first || driven(robot) < drawn[i].count;
      if (!drawn || robots.some(isAnother)) begin(robots, starts, size, scale, place);
      robots.forEach((robot, i) => {
        const { end } = drawn[i];
        if (!end || distance(end, place(robot.pose)) > covered) extend(robot, i, place);
      });
    },
  };
}

const distance = ([x, y], [toX, toY]) => Math.hypot(toX - x, toY - y);

// The parts of one robot in the picture, and what shows it.
function figure(figures, readout, name, number, count) {
  const look = `ros2lab-robot-${number}`;
  // 1 is the robot's radius: two wheels, a round body, and an arrow to the front.
  figures.insertAdjacentHTML("beforeend", `<svg class="ros2lab-body ${look}" viewBox="${-BODY} ${-BODY} ${2 * BODY} ${2 * BODY}">
    <path class="ros2lab-wheels" d="M-.5-1.15h1v.3h-1zM-.5.85h1v.3h-1z"/><circle r="1"/>
    <path class="ros2lab-arrow" d="M.8 0L-.4-.55L-.1 0L-.4.55z"/></svg>`);
  const body = figures.lastElementChild;
  const label = count > 1 ? figures.appendChild(document.createElement("div")) : null;
  if (label) [label.className, label.textContent] = ["ros2lab-name", name];
  const line = readout.appendChild(document.createElement("div"));
  const value = (key, unit) => `<span>${key} <b data-value="${key}"></b> ${unit}</span>`;
  line.innerHTML = `<span class="ros2lab-who"><svg width="30" height="10" aria-hidden="true"><path class="${look}" d="M1 5H29"/></svg></span>
    ${value("x", "m")}${value("y", "m")}${value("heading", "°")}${value("speed", "m/s")}${value("turning", "rad/s")}${value("radius", "m")}`;
  if (count > 1) line.firstChild.append(name);
  const values = Object.fromEntries([...line.querySelectorAll("b")].map((b) => [b.dataset.value, b]));
  let drawnRadius = 0, drawnAt = "";

  function show({ pose }, place, radius) {
    const [left, top] = place(pose);
    if (radius !== drawnRadius) {
      drawnRadius = radius;
      Object.assign(body.style, { width: `${2 * BODY * radius}px`, height: `${2 * BODY * radius}px`, margin: `${-BODY * radius}px` });
    }
    const at = `translate(${left}px, ${top}px) rotate(${-pose[2]}rad)`;
    if (at === drawnAt) return;
    body.style.transform = drawnAt = at;
    if (label) label.style.transform = `translate(${Math.round(left + radius + 5)}px, ${Math.round(top - 20)}px)`;
  }

  function tell([x, y, heading, linear, angular]) {
    const circle = linear && angular ? fixed(Math.abs(linear / angular)) : "–";
    const shown = { x: fixed(x), y: fixed(y), heading: fixed(degrees(heading), 0), speed: fixed(linear), turning: fixed(angular), radius: circle };
    for (const [key, text] of Object.entries(shown)) write(values[key], text);
  }

  return { show, tell };
}

const degrees = (heading) => ((((heading * 180) / Math.PI + 180) % 360) + 360) % 360 - 180;

const fixed = (value, digits = 2) => (Math.abs(value) < 0.5 * 10 ** -digits ? 0 : value).toFixed(digits).replace("-", "−");

const inWords = ([x, y, heading, linear, angular]) =>
  `x ${fixed(x)} m, y ${fixed(y)} m, heading ${fixed(degrees(heading), 0)}°, ${fixed(linear)} m/s, ${fixed(angular)} rad/s`;

function report(robots) {
  if (robots.every((robot) => !robot.isHeard)) return "no command yet";
  return robots.some(({ pose }) => pose[3] || pose[4]) ? "driving" : "standing";
}

// At most so many, evenly taken: the shape of the trail is kept, and a saved notebook small.
function thinned(trail) {
  const step = Math.ceil(trail.length / MOST_SAVED);
  return step > 1 ? trail.filter((_, i) => i % step === 0) : trail;
}

// The corners of the smallest rectangle around all robots and trails.
function bounds(robots) {
  const low = [Infinity, Infinity], high = [-Infinity, -Infinity];
  const include = (point) => {
    for (const axis of [0, 1]) {
      low[axis] = Math.min(low[axis], point[axis]);
      high[axis] = Math.max(high[axis], point[axis]);
    }
  };
  for (const robot of robots) {
    if (robot.bounded !== robot.trail || robot.known > robot.trail.length) [robot.bounded, robot.known, robot.box] = [robot.trail, 0, null];
    robot.box ??= [[...robot.pose.slice(0, 2)], [...robot.pose.slice(0, 2)]];
    for (const point of [...robot.trail.slice(robot.known), ...robot.ahead, robot.pose])
      for (const axis of [0, 1]) {
        robot.box[0][axis] = Math.min(robot.box[0][axis], point[axis]);
        robot.box[1][axis] = Math.max(robot.box[1][axis], point[axis]);
      }
    robot.known = robot.trail.length;
    robot.box.forEach(include);
  }
  return [low, high];
}

// A line at every round number of metres, about 60 pixels apart, and its number at the edge, but not in the corners.
function drawGrid(grid, view, [width, height], scale, place) {
  const step = roundStep(60 / scale);
  const lines = (middle, half) => {
    const first = Math.ceil((middle - half) / step), last = Math.floor((middle + half) / step);
    return Array.from({ length: Math.max(0, last - first + 1) }, (_, i) => (first + i) * step);
  };
  const text = (value) => String(Number(value.toPrecision(6))).replace("-", "−");
  const upright = lines(view.x, width / 2 / scale).map((x) => {
    const [left] = place([x, 0]);
    const name = left > 30 && left < width - 70 ? `<text x="${left + 3}" y="${height - 4}">${text(x)}</text>` : "";
    return `<path${x ? "" : ' class="ros2lab-axis"'} d="M${left} 0V${height}"/>${name}`;
  });
  const level = lines(view.y, height / 2 / scale).map((y) => {
    const [, top] = place([0, y]);
    const name = top > 32 && top < height - 8 ? `<text x="4" y="${top - 3}">${text(y)}</text>` : "";
    return `<path${y ? "" : ' class="ros2lab-axis"'} d="M0 ${top}H${width}"/>${name}`;
  });
  grid.innerHTML = `${upright.join("")}${level.join("")}
    <text class="ros2lab-unit" x="${width - 6}" y="${height - 4}" text-anchor="end">x (m)</text>
    <text class="ros2lab-unit" x="4" y="13">y (m)</text>`;
}
