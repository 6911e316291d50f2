import type { Run } from "../client";
import { Empty } from "../platform/Empty";
import { isActive } from "../runs/states";

/** Why there is no result: it is still to come, or the run ended before it came to it. */
export function NotYet({ run }: { run: Run }) {
  if (isActive(run.state)) {
    return <Empty title="Not yet">It appears here as soon as the run has come to it.</Empty>;
  }
  return (
    <Empty title="Nothing here">
      The run {run.state === "completed" ? "has no such result" : `was ${run.state} before it came to this`}.
    </Empty>
  );
}
