// Stands before the module of each view that is drawn again and again: when it draws, and whether anybody sees it.
// All views of a page share one clock. What they draw in one turn costs the browser one frame, and a frame costs more
// than most of what is drawn in it.

const TEXT_PERIOD = 200; // ms between two changes of texts and numbers, which nobody reads faster
const HIDDEN_FOR = 1000; // ms after which Python is told that nobody looks any more
const FIRST_PATIENCE = 500; // ms until Python is told or asked again, if it did not answer

const page = (globalThis[Symbol.for("ros2lab.page")] ??= (() => {
  const waiting = new Map(); // draw function -> from when on and until when it wants to be called (ms)
  const views = new Set();
  let frame = 0, timer = 0, due = Infinity, toldAt = 0;

  function turn() {
    const now = performance.now(), isTextTurn = now - toldAt > 0.9 * TEXT_PERIOD;
    frame = 0;
    if (isTextTurn) toldAt = now;
    for (const [draw, { from }] of [...waiting]) {
      if (from > now) continue;
      waiting.delete(draw);
      try {
        draw(isTextTurn);
      } catch (error) {
        console.error(error);
      }
    }
    wake();
  }

  function wake() {
    if (frame) return;
    const next = Math.min(...[...waiting.values()].map(({ until }) => until));
    if (next === due) return;
    clearTimeout(timer);
    due = next;
    const wait = due - performance.now();
    if (wait <= 0) begin();
    else if (wait < Infinity) timer = setTimeout(begin, wait);
  }

  function begin() {
    clearTimeout(timer);
    due = Infinity;
    frame ||= requestAnimationFrame(turn);
  }

  // A theme brings its colours a moment after its name.
  const onTheme = () => [0, 500].forEach((wait) => setTimeout(() => views.forEach((view) => view.onTheme()), wait));
  new MutationObserver(onTheme).observe(document.body, { attributes: true, attributeFilter: ["data-jp-theme-name", "data-jp-theme-light"] });

  return {
    id: Array.from(crypto.getRandomValues(new Uint32Array(2)), (part) => part.toString(16)).join(""),
    views,
    // Call `draw` in the first turn after `after` ms that another view wants, or one of its own `within` ms later.
    ask(draw, { after = 0, within = 0 } = {}) {
      const from = performance.now() + after, before = waiting.get(draw);
      waiting.set(draw, { from: Math.min(from, before?.from ?? from), until: Math.min(from + within, before?.until ?? Infinity) });
      wake();
    },
    forget: (draw) => waiting.delete(draw),
    untilText: () => Math.max(0, toldAt + TEXT_PERIOD - performance.now()),
  };
})());

// One a model: tells Python whether one of its views on this page is seen, until it knows.
function audience() {
  const views = new Set();
  let timer = 0, isAlone = false;

  function tell(model, patience = FIRST_PATIENCE) {
    const isSeen = views.size > 0, known = model.get("watchers");
    clearTimeout(timer);
    if (isAlone || (known ?? []).includes(page.id) === isSeen && (isSeen || known)) return;
    try {
      model.send({ seen: isSeen, page: page.id });
    } catch {
      return; // its kernel has gone
    }
    timer = setTimeout(tell, patience, model, 2 * patience);
  }

  return {
    // From a notebook whose kernel has gone: nobody is there to be told.
    beAlone: () => (isAlone = true),
    see(model, view, isSeen, isAtOnce) {
      isSeen ? views.add(view) : views.delete(view);
      clearTimeout(timer);
      // What is scrolled past, or drawn in another place, is soon seen again.
      if (isSeen || isAtOnce) tell(model);
      else timer = setTimeout(tell, HIDDEN_FOR, model);
    },
  };
}

// Calls `draw`, when it is asked to, in the page's next turn, as long as somebody sees the element: with whether texts
// have their turn. What was asked for in the meantime is drawn when it is seen again.
function onScreen(model, el, seenBy, draw, onSeen = () => {}) {
  let isVisible = false, isStale = true, hasNewTheme = false, wasSeen = false;
  const view = {};
  const isSeen = () => isVisible && !document.hidden && el.isConnected;

  function turn(isTextTurn) {
    isStale = !isSeen();
    if (isStale) return;
    const isNewTheme = hasNewTheme;
    hasNewTheme = false;
    draw(isTextTurn, isNewTheme);
  }

  function ask(when) {
    if (isSeen()) page.ask(turn, when);
    else isStale = true;
  }

  function look() {
    if (isSeen() && isStale) page.ask(turn);
    seenBy.see(model, view, isSeen(), document.hidden);
    if (isSeen() !== wasSeen) onSeen((wasSeen = isSeen()));
  }

  const observer = new IntersectionObserver((entries) => {
    isVisible = entries.at(-1).isIntersecting;
    look();
  });
  const leave = () => seenBy.see(model, view, false, true);
  view.onTheme = () => ((hasNewTheme = true), ask());
  page.views.add(view);
  observer.observe(el);
  document.addEventListener("visibilitychange", look);
  addEventListener("pagehide", leave);
  return {
    ask,
    isSeen,
    end() {
      observer.disconnect();
      document.removeEventListener("visibilitychange", look);
      removeEventListener("pagehide", leave);
      page.views.delete(view);
      page.forget(turn);
      seenBy.see(model, view, false, false);
    },
  };
}

// Clears a canvas of this size (px) and returns what draws on it, in px, as finely as the screen shows it. With a colour
// for its paper it is opaque, and the browser need not draw what is behind it.
function cleared(canvas, width, height, paper = null) {
  const pen = canvas.getContext("2d", { alpha: !paper }), scale = devicePixelRatio;
  const [columns, rows] = [Math.round(width * scale), Math.round(height * scale)];
  if (canvas.width !== columns || canvas.height !== rows) [canvas.width, canvas.height] = [columns, rows];
  pen.setTransform(scale, 0, 0, scale, 0, 0);
  pen.clearRect(0, 0, width, height);
  pen.fillStyle = paper ?? "transparent";
  pen.fillRect(0, 0, width, height);
  return pen;
}

// Asks Python for all that there is. JupyterLab may lose a message right after a page is loaded, so ask until there is
// an answer.
function askFor(what, model, state, patience = FIRST_PATIENCE) {
  if (state.isWhole) return;
  model.send({ ask: what });
  setTimeout(askFor, patience, what, model, state, 2 * patience);
}

const crisp = (length) => Math.round(length) + 0.5; // where a line of 1 px fills one

function write(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

