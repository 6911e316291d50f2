import { type ComponentType, useEffect, useState } from "react";
import { Loading } from "./QueryView";

/**
 * A part of the page that comes with its first use, or before it where `preload` was called. Not `React.lazy`: what
 * takes the place of a Suspense fallback is held back for 300 ms by React, however soon it is there.
 */
export function later<Props extends object>(load: () => Promise<ComponentType<Props>>, height = 420) {
  let loaded: ComponentType<Props> | null = null;
  const preload = async () => {
    loaded ??= await load();
    return loaded;
  };
  function Later(props: Props) {
    const [Part, setPart] = useState(() => loaded);
    useEffect(() => {
      if (Part) return;
      let isWanted = true;
      preload().then(
        (part) => isWanted && setPart(() => part),
        // Thrown while it is drawn, so that the page's own error is shown.
        (error: unknown) =>
          isWanted &&
          setPart(() => {
            throw error;
          }),
      );
      return () => {
        isWanted = false;
      };
    }, [Part]);
    return Part ? <Part {...props} /> : <Loading rows={1} height={height} />;
  }
  return Object.assign(Later, { preload });
}

/** Do something once the page has nothing more urgent to do. */
export function whenIdle(act: () => void): void {
  if ("requestIdleCallback" in window) window.requestIdleCallback(act, { timeout: 4_000 });
  else setTimeout(act, 1_000);
}
