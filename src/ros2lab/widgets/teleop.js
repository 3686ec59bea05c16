// Drives a robot with keys and a round pad. The browser says what is wanted while something is held; Python publishes,
// and stops the robot as soon as it hears nothing.

const HEARTBEAT = 100; // ms
const LEAST_GAP = 50; // ms between two messages: 20 Hz at most
const PATIENCE = 700; // ms for an answer, after which the kernel is called busy
const DEAD_ZONE = 0.08; // of the pad's radius
const RADIUS = 84, KNOB = 22; // of the pad, in the units of its drawing
const KEYS = {
  ArrowUp: [1, 0], KeyW: [1, 0], ArrowDown: [-1, 0], KeyS: [-1, 0],
  ArrowLeft: [0, 1], KeyA: [0, 1], ArrowRight: [0, -1], KeyD: [0, -1],
};
const REST = [0, 0];

export default () => {
  const state = { isSaved: false };

  function initialize({ model }) {
    // From a notebook whose kernel has gone.
    if (model.get("saved")) state.isSaved = true;
    else model.set("saved", true);
  }

  function render({ model, el }) {
    el.classList.add("ros2lab-card", "ros2lab-teleop");
    const arrow = (angle) => `<path class="ros2lab-arrow" d="M-9 -60L0 -72L9 -60" transform="rotate(${angle})"/>`;
    el.innerHTML = `
      <div class="ros2lab-head"><span class="ros2lab-title">Drive</span> <code></code><span class="ros2lab-news"></span></div>
      <div class="ros2lab-cockpit" tabindex="0" role="application" data-lm-suppress-shortcuts="true">
        <svg class="ros2lab-pad" viewBox="-100 -100 200 200" aria-hidden="true">
          <circle class="ros2lab-rim" r="${RADIUS}"/>${[0, 90, 180, 270].map(arrow).join("")}
          <path class="ros2lab-stick" d="M0 0"/><circle class="ros2lab-knob" r="${KNOB}"/></svg>
        <div class="ros2lab-dials">
          <div class="ros2lab-call"></div>
          <div class="ros2lab-figures"><div><span>linear x</span><b data-value="linear"></b> m/s</div>
            <div><span>angular z</span><b data-value="angular"></b> rad/s</div></div>
          <div class="ros2lab-note">Hold <kbd>↑</kbd> <kbd>←</kbd> <kbd>↓</kbd> <kbd>→</kbd> or <kbd>W</kbd> <kbd>A</kbd>
            <kbd>S</kbd> <kbd>D</kbd>, or drag the knob. <kbd>Shift</kbd> halves the speed, <kbd>Space</kbd> stops.</div>
        </div></div>
      <div class="ros2lab-spoken" role="status" aria-live="polite"></div>`;
    const [topic, news, cockpit, pad, knob, stick, call, spoken] = ["code", ".ros2lab-news", ".ros2lab-cockpit", ".ros2lab-pad",
      ".ros2lab-knob", ".ros2lab-stick", ".ros2lab-call", ".ros2lab-spoken"].map((selector) => el.querySelector(selector));
    const page = Math.random().toString(36).slice(2);
    const pressed = new Set();
    let drag = null; // the pointer's wish, while it is held
    let isSlow = false, count = 0, hold = null, isGranted = false, sentAt = 0, trailing = 0, heartbeat = 0, waiting = 0;
    let reason = "";
    topic.textContent = model.get("topic");
    cockpit.setAttribute("aria-label", `Drive ${model.get("topic")}: hold an arrow key, or W, A, S or D, while this has the focus. ` +
      "Shift halves the speed. Letting go stops the robot.");
    if (state.isSaved) cockpit.removeAttribute("tabindex");

    // What is wanted, as fractions of the greatest linear and angular speed.
    function wish() {
      const [forwards, left] = drag ?? [...pressed].map((key) => KEYS[key]).reduce(([a, b], [c, d]) => [a + c, b + d], REST);
      const factor = isSlow ? 0.5 : 1;
      return [forwards, left].map((value) => factor * Math.max(-1, Math.min(1, value)));
    }

    function changed() {
      const isHeld = drag !== null || pressed.size > 0;
      if (isHeld && hold === null) begin();
      else if (!isHeld && hold !== null) release();
      else if (isHeld) send();
      show();
    }

    function begin() {
      hold = `${page}-${++count}`;
      [isGranted, reason] = [false, ""];
      model.send({ do: "begin", hold });
      waiting = setTimeout(() => {
        reason = "Waiting for the kernel: it is busy.";
        show();
      }, PATIENCE);
    }

    function send() {
      clearTimeout(trailing);
      if (!isGranted) return;
      const wait = sentAt + LEAST_GAP - performance.now();
      if (wait > 0) {
        trailing = setTimeout(send, wait);
        return;
      }
      sentAt = performance.now();
      const [linear, angular] = wish();
      model.send({ do: "drive", hold, linear, angular });
    }

    function letGo() {
      for (const timer of [trailing, waiting]) clearTimeout(timer);
      clearInterval(heartbeat);
      [hold, isGranted, drag] = [null, false, null];
      pressed.clear();
    }

    function release() {
      if (hold !== null) model.send({ do: "end", hold });
      letGo();
      reason = "";
      show();
    }

    function onMessage(message) {
      if (message.hold !== hold) return;
      clearTimeout(waiting);
      if (message.is_granted) {
        [isGranted, reason] = [true, ""];
        clearInterval(heartbeat);
        heartbeat = setInterval(send, HEARTBEAT);
        send();
      } else {
        letGo();
        reason = `Stopped: ${message.reason}. Let go, then hold again.`;
      }
      show();
    }

    function show() {
      const isFocused = cockpit.contains(document.activeElement) && document.hasFocus();
      const isHeld = hold !== null;
      el.classList.toggle("ros2lab-ready", isFocused);
      el.classList.toggle("ros2lab-driving", isHeld && isGranted);
      const [linear, angular] = wish();
      const reach = (RADIUS - KNOB) / Math.max(1, Math.hypot(linear, angular));
      const [x, y] = [-angular * reach, -linear * reach];
      knob.setAttribute("transform", `translate(${x} ${y})`);
      stick.setAttribute("d", `M0 0L${x} ${y}`);
      const text = state.isSaved ? "Its kernel has ended"
        : reason ? reason : isHeld && isGranted ? "Driving" : isFocused ? "Ready: hold a key" : "Click here to drive";
      if (call.textContent !== text) call.textContent = text;
      speak(reason || (isHeld && isGranted ? `Driving ${direction(linear, angular)}` : isFocused ? "Stopped, ready" : ""));
    }

    function speak(text) {
      if (spoken.textContent !== text) spoken.textContent = text;
    }

    function showVelocity() {
      for (const key of ["linear", "angular"])
        el.querySelector(`[data-value=${key}]`).textContent = (model.get(key) + 0).toFixed(2).replace(/^-(?!0\.00$)/, "−").replace("-", "");
    }

    function showListeners() {
      const listeners = model.get("listeners");
      news.textContent = state.isSaved ? "as it was when its kernel ended"
        : listeners ? `${listeners} ${listeners === 1 ? "node listens" : "nodes listen"}` : "nobody listens yet";
      news.classList.toggle("ros2lab-silent", !listeners && !state.isSaved);
    }

    cockpit.addEventListener("keydown", (event) => {
      if (state.isSaved || event.ctrlKey || event.metaKey || event.altKey) return release();
      const isOurs = event.code in KEYS || event.code === "Space" || event.key === "Shift";
      if (!isOurs) return;
      // JupyterLab would insert and delete cells, and the page would scroll.
      event.preventDefault();
      event.stopPropagation();
      isSlow = event.shiftKey;
      if (event.code === "Space") return release();
      if (event.code in KEYS && !event.repeat) pressed.add(event.code);
      changed();
    });
    cockpit.addEventListener("keyup", (event) => {
      isSlow = event.shiftKey;
      if (pressed.delete(event.code) || event.key === "Shift") {
        event.stopPropagation();
        changed();
      }
    });

    function follow(event) {
      const box = pad.getBoundingClientRect(), scale = 200 / box.width;
      const x = (event.clientX - box.left) * scale - 100, y = (event.clientY - box.top) * scale - 100;
      const reach = Math.hypot(x, y) / (RADIUS - KNOB);
      const size = reach < DEAD_ZONE ? 0 : Math.min(1, reach) / reach / (RADIUS - KNOB);
      drag = [-y * size, -x * size];
      isSlow = event.shiftKey;
      changed();
    }

    pad.addEventListener("pointerdown", (event) => {
      if (state.isSaved || event.button !== 0) return;
      event.preventDefault();
      cockpit.focus({ preventScroll: true });
      pad.setPointerCapture(event.pointerId);
      follow(event);
    });
    pad.addEventListener("pointermove", (event) => drag && follow(event));
    for (const name of ["pointerup", "pointercancel", "lostpointercapture"])
      pad.addEventListener(name, () => {
        if (!drag) return;
        drag = null;
        changed();
      });
    cockpit.addEventListener("contextmenu", release);
    cockpit.addEventListener("focusin", show);
    cockpit.addEventListener("focusout", release);
    const onHidden = () => document.hidden && release();
    const onLeaving = () => release();
    document.addEventListener("visibilitychange", onHidden);
    addEventListener("pagehide", onLeaving);
    addEventListener("blur", onLeaving);
    addEventListener("focus", show);
    const seen = new IntersectionObserver((entries) => !entries.at(-1).isIntersecting && hold !== null && release());
    seen.observe(cockpit);

    model.on("msg:custom", onMessage);
    for (const key of ["linear", "angular"]) model.on(`change:${key}`, showVelocity);
    model.on("change:listeners", showListeners);
    showVelocity();
    showListeners();
    show();
    return () => {
      release();
      seen.disconnect();
      document.removeEventListener("visibilitychange", onHidden);
      removeEventListener("pagehide", onLeaving);
      removeEventListener("blur", onLeaving);
      removeEventListener("focus", show);
    };
  }

  return { initialize, render };
};

function direction(linear, angular) {
  const words = [];
  if (linear) words.push(linear > 0 ? "forwards" : "backwards");
  if (angular) words.push(angular > 0 ? "turning left" : "turning right");
  return words.join(", ") || "with zero velocity";
}
