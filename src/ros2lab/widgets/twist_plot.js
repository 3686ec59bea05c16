// Draws linear x and angular z of a Twist topic against time.
// Python sends each sample once, as three float64 (s, m/s, rad/s); what is on the screen is kept here.

const SERIES = [
  { name: "linear x", unit: "m/s", column: 1, key: "linear" },
  { name: "angular z", unit: "rad/s", column: 2, key: "angular" },
];
const LEFT = 58, RIGHT = 10, TOP = 6, BOTTOM = 34, BETWEEN = 16;
const MOST_SAVED = 2000; // samples, in a saved notebook
const SPOKEN_PERIOD = 2000; // ms between two texts for screen readers
const PATIENCE = 45; // ms for which what has come waits for a frame that another view draws
const DASHES = { linear: [], angular: [7, 3] }; // px

// Called once a model: its views share the samples, and a new view finds them all.
export default () => {
  const clock = () => performance.now() / 1000; // s
  const state = { samples: [], offset: -clock(), isWhole: false, isSaved: false, pausedAt: null, clickedAt: -Infinity, moment: null };
  const seenBy = audience();
  const now = () => clock() + state.offset; // s, on Python's clock

  function initialize({ model }) {
    if (model.get("span")) {
      state.samples = rowsOf(model.get("recorded"), 3);
      seenBy.beAlone();
      return;
    }
    const saved = model.get("saved");
    if (saved) {
      // From a notebook whose kernel has gone: it stands still where it was.
      Object.assign(state, { samples: saved.samples, pausedAt: saved.now, isSaved: true });
      seenBy.beAlone();
      return;
    }
    // Read when JupyterLab saves the notebook, and not before; Python knows nothing of it.
    model.set("saved", {
      // Of a plot that nobody sees, what came last is not known.
      get now() { return state.pausedAt ?? (model.get("watchers")?.length === 0 ? state.toldAt : now()); },
      get samples() { return newest(state.samples, this.now - model.get("window")); },
    });
    model.on("msg:custom", (message, [buffer]) => {
      const { byteOffset: at, byteLength: length } = buffer;
      const numbers = new Float64Array(buffer.buffer.slice(at, at + length));
      if (message.is_whole) [state.samples, state.isWhole] = [[], true];
      for (let i = 0; i < numbers.length; i += 3) state.samples.push(numbers.slice(i, i + 3));
      const oldest = message.now - message.kept;
      const first = state.samples.findIndex((sample) => sample[0] >= oldest);
      if (first > 0) state.samples.splice(0, first);
      [state.offset, state.toldAt] = [message.now - clock(), message.now];
      if (model.get("paused")) state.pausedAt ??= now();
    });
    model.on("change:paused", () => (state.pausedAt = model.get("paused") ? now() : null));
    askFor("samples", model, state);
  }

  function render({ model, el }) {
    el.classList.add("ros2lab-card", "ros2lab-plot");
    return model.get("span") ? renderRecorded(model, el) : renderLive(model, el);
  }

  function renderRecorded(model, el) {
    const span = model.get("span"), name = model.get("recording"), topic = model.get("topic");
    el.innerHTML = `${content("")}<div class="ros2lab-cursor"></div>`;
    el.querySelector("code").textContent = topic;
    el.querySelector(".ros2lab-news").textContent = `recorded: ${name}`;
    const canvas = el.querySelector(".ros2lab-canvas"), cursor = el.querySelector(".ros2lab-cursor");
    const gap = longestGap(state.samples, state.samples.length);
    const screen = onScreen(model, el, seenBy, draw);
    let spokenAt = -Infinity, size = [0, 0], isDrawn = false;

    function draw(isTextTurn, isNewTheme) {
      if (!size[0]) return;
      if (!isDrawn || isNewTheme) picture(canvas, size, state.samples, 0, span, span, gap);
      isDrawn = true;
      const across = LEFT + (state.moment / span) * (size[0] - RIGHT - LEFT);
      cursor.style.height = `${size[1] - TOP - BOTTOM}px`;
      cursor.style.transform = `translate(${canvas.offsetLeft + across}px, ${canvas.offsetTop + TOP}px)`;
      if (isTextTurn) tellMoment();
      else screen.ask({ after: page.untilText(), within: PATIENCE });
    }

    function tellMoment() {
      const { moment } = state, last = state.samples[rowAt(state.samples, moment)];
      const values = tell(el, last[0] <= moment && moment - last[0] <= gap ? last : null);
      if (performance.now() - spokenAt < SPOKEN_PERIOD) return;
      spokenAt = performance.now();
      canvas.setAttribute("aria-label", `Plot of ${topic} against time, recorded; at ${moment.toFixed(1)} s: ${values}.`);
    }

    const leave = timeline(el, { name, span }, state, () => screen.ask());
    const resized = new ResizeObserver(() => {
      size = [canvas.clientWidth, canvas.clientHeight];
      isDrawn = false;
      screen.ask();
    });
    resized.observe(canvas);
    return () => {
      leave();
      screen.end();
      resized.disconnect();
    };
  }

  function renderLive(model, el) {
    const [least, most] = model.get("window_range");
    el.innerHTML = content(`
        <label>window <input type="number" class="jp-mod-styled" min="${least}" max="${most}" step="1"> s</label>
        <button type="button" class="jp-mod-styled"></button>`);
    const [topic, news, input, button, canvas] =
      ["code", ".ros2lab-news", "input", "button", ".ros2lab-canvas"].map((selector) => el.querySelector(selector));
    topic.textContent = model.get("topic");
    const isSaved = state.isSaved;
    input.disabled = button.disabled = isSaved;
    const period = 1000 / model.get("rate");
    const screen = onScreen(model, el, seenBy, draw);
    let spokenAt = 0, size = [0, 0];

    function draw(isTextTurn) {
      if (!size[0]) return;
      const end = state.pausedAt ?? now(), window = model.get("window"), gap = longestGap(state.samples);
      const begin = Math.max(0, end - window);
      picture(canvas, size, state.samples, begin, begin + window, end, gap);
      const isPaused = model.get("paused") || isSaved;
      if (isTextTurn) tellNewest(end, gap, isPaused);
      else screen.ask({ after: page.untilText(), within: PATIENCE });
      // The time goes on when no message comes.
      if (!isPaused) screen.ask({ after: 1.5 * period, within: PATIENCE });
    }

    function tellNewest(end, gap, isPaused) {
      const last = state.samples.findLast((sample) => sample[0] <= end);
      const values = tell(el, last);
      write(news, isSaved ? "as it was when its kernel ended" : report(state.samples, last, end, gap, isPaused));
      news.classList.toggle("ros2lab-silent", !isPaused && !(last && end - last[0] < gap));
      if (performance.now() - spokenAt < SPOKEN_PERIOD) return;
      spokenAt = performance.now();
      canvas.setAttribute("aria-label", `Plot of ${topic.textContent} against time: ${values}; ${news.textContent}.`);
    }

    function showControls() {
      input.value = model.get("window");
      button.textContent = model.get("paused") ? "Resume" : "Pause";
      spokenAt = 0;
      screen.ask();
    }

    input.addEventListener("change", () => {
      const wanted = Math.min(most, Math.max(least, input.valueAsNumber || model.get("window")));
      model.set("window", wanted);
      model.save_changes();
      showControls();
    });
    button.addEventListener("click", () => {
      state.clickedAt = clock();
      model.set("paused", !model.get("paused"));
      model.save_changes();
    });
    const receive = () => screen.ask({ within: PATIENCE });
    model.on("msg:custom", receive);
    model.on("change:window", showControls);
    model.on("change:paused", showControls);
    const resized = new ResizeObserver(() => {
      size = [canvas.clientWidth, canvas.clientHeight];
      screen.ask();
      // Pausing stores a picture, for which JupyterLab makes the view anew: the keyboard stays on its button.
      if (clock() - state.clickedAt < 5 && document.activeElement === document.body) button.focus();
    });
    resized.observe(canvas);
    showControls();
    return () => {
      screen.end();
      resized.disconnect();
      model.off("msg:custom", receive);
      model.off("change:window", showControls);
      model.off("change:paused", showControls);
    };
  }

  return { initialize, render };
};

function content(controls) {
  const entry = (s) => `<span><svg width="30" height="10" aria-hidden="true"><path class="ros2lab-${s.key}" d="M1 5H29"/></svg>
    ${s.name} <b data-value="${s.key}"></b> ${s.unit}</span>`;
  return `
    <div class="ros2lab-head"><span class="ros2lab-title">Twist</span> <code></code>
      <span class="ros2lab-news"></span>${controls}</div>
    <div class="ros2lab-legend">${SERIES.map(entry).join("")}</div>
    <canvas class="ros2lab-canvas" role="img"></canvas>`;
}

// Shows the values of a sample, if there is one, and returns them in words.
function tell(el, sample) {
  const value = (s) => (sample ? sample[s.column].toFixed(2).replace("-", "−") : "–");
  for (const s of SERIES) write(el.querySelector(`[data-value=${s.key}]`), value(s));
  return SERIES.map((s) => `${s.name} ${value(s)} ${s.unit}`).join(", ");
}

function newest(samples, begin) {
  return samples.filter((sample) => sample[0] > begin).slice(-MOST_SAVED).map((sample) => Array.from(sample));
}

// A silence longer than this (s) is drawn as one: the values are not held over it.
function longestGap(samples, count = 30) {
  const recent = samples.slice(-count);
  const gaps = recent.slice(1).map((sample, i) => sample[0] - recent[i][0]).sort((a, b) => a - b);
  return Math.max(1, 4 * (gaps[gaps.length >> 1] ?? 0));
}

function report(samples, last, end, gap, isPaused) {
  if (isPaused) return "paused";
  if (!last) return "no message yet";
  if (end - last[0] >= gap) return `no message for ${(end - last[0]).toFixed(1)} s`;
  const recent = samples.filter((sample) => sample[0] > end - 3);
  const span = recent.length ? recent.at(-1)[0] - recent[0][0] : 0;
  return span > 0 ? `${((recent.length - 1) / span).toFixed(1)} Hz` : "";
}

// One panel a series, one above the other, over the same time: their units differ.
function picture(canvas, [width, height], samples, begin, until, end, gap) {
  const style = getComputedStyle(canvas), colour = (name) => style.getPropertyValue(`--${name}`);
  const pen = cleared(canvas, width, height, colour("paper"));
  const right = width - RIGHT, bottom = height - BOTTOM;
  const x = (time) => LEFT + (Math.max(0, time - begin) / (until - begin)) * (right - LEFT);
  const panelHeight = (height - TOP - BOTTOM - BETWEEN) / 2;
  // The last one before the window holds into it.
  const shown = samples.filter((sample, i) => sample[0] <= end && (samples[i + 1]?.[0] ?? sample[0] + gap) >= begin);
  const times = ticks(begin, until, Math.max(2, width / 90));
  pen.font = `11px ${style.fontFamily}`;
  SERIES.forEach((s, i) => {
    const top = TOP + i * (panelHeight + BETWEEN);
    const [low, high] = limits(shown, s.column);
    const y = (value) => top + ((high - value) / (high - low)) * panelHeight;
    const levels = ticks(low, high, 3);
    const grid = new Path2D();
    for (const level of levels) line(grid, LEFT, crisp(y(level)), right, crisp(y(level)));
    for (const time of times) line(grid, crisp(x(time)), top, crisp(x(time)), top + panelHeight);
    stroke(pen, grid, colour("grid"), 1);
    const frame = new Path2D();
    frame.rect(crisp(LEFT), crisp(top), Math.round(right - LEFT), Math.round(panelHeight));
    stroke(pen, frame, colour("frame"), 1);
    stroke(pen, steps(shown, s.column, x, y, gap, end), colour(s.key), 2, DASHES[s.key]);
    pen.fillStyle = colour("faint");
    pen.textAlign = "right";
    for (const level of levels) pen.fillText(label(level), LEFT - 6, y(level) + 4);
    pen.save();
    pen.translate(12, top + panelHeight / 2);
    pen.rotate(-Math.PI / 2);
    pen.textAlign = "center";
    pen.fillStyle = colour("ink");
    pen.fillText(s.name, 0, 0);
    pen.fillText(`(${s.unit})`, 0, 13);
    pen.restore();
  });
  pen.textAlign = "center";
  pen.fillStyle = colour("faint");
  for (const time of times) pen.fillText(label(time), x(time), bottom + 15);
  pen.fillStyle = colour("ink");
  pen.fillText("time (s)", (LEFT + right) / 2, height - 4);
}

function line(path, x, y, toX, toY) {
  path.moveTo(x, y);
  path.lineTo(toX, toY);
}

function stroke(pen, path, colour, width, dashes = []) {
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.setLineDash(dashes);
  pen.stroke(path);
}

// A command holds until the next one: steps, drawn where something changes, broken where nothing came.
function steps(samples, column, x, y, gap, end) {
  const path = new Path2D();
  let before = null, level = null;
  for (const sample of samples) {
    const across = x(sample[0]), up = y(sample[column]);
    if (before !== null && sample[0] - before > gap) path.lineTo(x(before), level);
    if (before === null || sample[0] - before > gap) {
      path.moveTo(across, up);
      path.lineTo(across + 1, up);
    } else if (up !== level) {
      path.lineTo(across, level);
      path.lineTo(across, up);
    }
    [before, level] = [sample[0], up];
  }
  if (before !== null) path.lineTo(x(end - before > gap ? before : end), level);
  return path;
}

// The range of the values and zero, and a little more.
function limits(samples, column) {
  let low = 0, high = 0;
  for (const sample of samples) [low, high] = [Math.min(low, sample[column]), Math.max(high, sample[column])];
  const room = 0.1 * (high - low) || 1;
  return [low - room, high + room];
}

function ticks(low, high, count) {
  const rough = (high - low) / count, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((factor) => factor * power >= 0.99 * rough) * power;
  const first = Math.ceil(low / step), length = Math.max(0, Math.floor(high / step) - first + 1);
  return Array.from({ length }, (_, i) => (first + i) * step);
}

const label = (value) => String(Number(value.toPrecision(6))).replace("-", "−");
