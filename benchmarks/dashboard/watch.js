// When the page last did anything: answers that came, changes of the document. Read by benchmarks/dashboard/browser.py.
(() => {
  const seen = { n_open: 0, last_ms: 0 };
  window.dropflowActivity = seen;
  const now = () => { seen.last_ms = performance.now(); };
  const ask = window.fetch;
  window.fetch = async (...asked) => {
    seen.n_open += 1;
    try { return await ask(...asked); } finally { seen.n_open -= 1; now(); }
  };
  const watch = () => new MutationObserver(now).observe(document.documentElement,
    { subtree: true, childList: true, attributes: true, characterData: true });
  if (document.documentElement) watch(); else document.addEventListener("readystatechange", watch, { once: true });
})();
