// When the page last changed: its document, or a canvas in it; and how long an input waited for the next picture.
// Read by benchmarks/dashboard/browser.py.
(() => {
  const seen = { n_open: 0, last_ms: 0, began_ms: 0, answered_ms: 0 };
  window.dropflowActivity = seen;
  const now = () => { seen.last_ms = performance.now(); };
  const ask = window.fetch;
  window.fetch = async (...asked) => {
    seen.n_open += 1;
    try { return await ask(...asked); } finally { seen.n_open -= 1; }
  };
  const drawing = CanvasRenderingContext2D.prototype;
  const clear = drawing.clearRect;
  // Whoever draws on a canvas that is in the page clears it first, and is through with it in the same task.
  drawing.clearRect = function (...place) {
    if (this.canvas.isConnected) queueMicrotask(now);
    return clear.apply(this, place);
  };
  for (const input of ["pointerup", "keydown"])
    window.addEventListener(input, ({ timeStamp }) => { seen.began_ms = timeStamp; }, true);
  // As Interaction to Next Paint has it: from the input to the picture after it, in steps of 8 ms.
  new PerformanceObserver((list) => {
    for (const { interactionId, startTime, duration } of list.getEntries())
      if (interactionId && startTime >= seen.began_ms - 20) seen.answered_ms = Math.max(seen.answered_ms, duration);
  }).observe({ type: "event", durationThreshold: 16, buffered: true });
  const watch = () => new MutationObserver(now).observe(document.documentElement,
    { subtree: true, childList: true, attributes: true, characterData: true });
  if (document.documentElement) watch(); else document.addEventListener("readystatechange", watch, { once: true });
})();
