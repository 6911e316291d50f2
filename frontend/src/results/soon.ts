/**
 * Do something in a task of its own, one such task after the other: what is asked of the service in the same moment is
 * asked first, the page answers between two plots, and of what changes twice at once only the last is drawn.
 */
export function soon(act: () => void): () => void {
  const turn = { act: act as (() => void) | null };
  waiting.push(turn);
  if (waiting.length === 1) setTimeout(next);
  return () => {
    turn.act = null;
  };
}

const waiting: { act: (() => void) | null }[] = [];

function next(): void {
  while (waiting.length > 0) {
    const { act } = waiting.shift() as { act: (() => void) | null };
    if (!act) continue;
    if (waiting.length > 0) setTimeout(next);
    act();
    return;
  }
}
