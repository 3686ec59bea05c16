// Draws nothing: it watches the card in which it is, which ipywidgets draws.

export default () => {
  const seenBy = audience();

  function initialize({ model }) {
    if (model.get("saved")) seenBy.beAlone();
    else model.set("saved", true);
  }

  function render({ model, el }) {
    el.style.display = "none";
    let screen = null;
    // It is put into the card after it is made.
    const placed = setInterval(() => {
      const card = el.closest(".ros2lab-card");
      if (!card) return;
      clearInterval(placed);
      screen = onScreen(model, card, seenBy, () => {});
    }, 100);
    return () => {
      clearInterval(placed);
      screen?.end();
    };
  }

  return { initialize, render };
};
