// Tells Python once all parts of a dashboard are in the page, until it answers.

export default () => {
  let isAnswered = false;

  function initialize({ model }) {
    // From a notebook whose kernel has gone: nobody would answer.
    isAnswered = Boolean(model.get("saved"));
    if (!isAnswered) model.set("saved", true);
    model.on("msg:custom", () => (isAnswered = true));
  }

  function render({ model, el }) {
    el.style.display = "none";
    tell(model, 500);
  }

  function tell(model, patience) {
    if (isAnswered) return;
    model.send({ arrived: true });
    setTimeout(() => tell(model, 2 * patience), patience);
  }

  return { initialize, render };
};
