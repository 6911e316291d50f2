import type { Run } from "../client";
import { Empty } from "../platform/Empty";
import { isActive } from "../runs/states";

/** Why there is no result: it is still to come, or the run ended before it came to it. */
export function NotYet({ run }: { run: Run }) {
  if (isActive(run.state)) {
    return <Empty title="Not yet">It appears here as soon as the run has come to it.</Empty>;
  }
  if (run.state === "completed") {
    return (
      <Empty title="Nothing here">
        The run has no such result: a film of one frame has nothing that moves, and earlier versions kept
        less. A new run of the experiment makes what can be made of its frames.
      </Empty>
    );
  }
  const isFailed = run.state === "failed";
  return (
    <Empty title="Nothing here">
      The run {isFailed ? "failed" : "was cancelled"} before it came to this.{" "}
      {isFailed
        ? "What went wrong stands at the top of this page; from there you can try it again, or run"
        : "Run"}{" "}
      it with other parameters: what is done already is not computed anew.
    </Empty>
  );
}
