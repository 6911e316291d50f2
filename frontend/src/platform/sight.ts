import { type RefObject, useEffect, useState } from "react";

/** As much below and above the window counts as seen, so that scrolling meets what is there already. */
const MARGIN_PX = 120;

/** Whether an element is in sight or nearly so: what is not need not be asked for, nor drawn. */
export function useInSight(ref: RefObject<HTMLElement | null>): boolean {
  const [isSeen, setSeen] = useState(false);
  useEffect(() => {
    const element = ref.current;
    if (!element) return;
    // At once, for the observer's first word comes a frame later.
    const { top, bottom } = element.getBoundingClientRect();
    setSeen(top < window.innerHeight + MARGIN_PX && bottom > -MARGIN_PX);
    const observer = new IntersectionObserver(
      (entries) => setSeen(entries[entries.length - 1]?.isIntersecting ?? false),
      { rootMargin: `${MARGIN_PX}px 0px` },
    );
    observer.observe(element);
    return () => observer.disconnect();
  }, [ref]);
  return isSeen;
}
