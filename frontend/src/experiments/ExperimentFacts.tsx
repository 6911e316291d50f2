import { Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import type { Experiment } from "../client";
import type { Document } from "../forms/document";
import { type Field, fieldsOf, type JsonSchema } from "../forms/schema";
import { inWords, leavesOf } from "../forms/words";
import { confirmedBy } from "../frames/confirmed";
import { type Fact, Facts } from "../platform/Facts";
import { formatBytes, formatCount, formatDuration, plural } from "../platform/format";
import { Moment } from "../platform/Moment";
import { QueryView } from "../platform/QueryView";
import { experimentSchemaQuery } from "./queries";

const SHOWN_ELSEWHERE = new Set(["name", "tags", "notes"]);

/** The description, field by field, in the words of its schema. */
export function Description({ experiment }: { experiment: Experiment }) {
  const document = experiment.experiment;
  const schema = useQuery(experimentSchemaQuery);
  return (
    <>
      <QueryView query={schema}>
        {(loaded) => <Facts facts={factsOf(loaded as JsonSchema, document)} label="What was filmed" />}
      </QueryView>
      {typeof document.notes === "string" && document.notes && (
        <Text fz="sm" style={{ whiteSpace: "pre-wrap" }}>
          {document.notes}
        </Text>
      )}
    </>
  );
}

function factsOf(schema: JsonSchema, document: Document): Fact[] {
  return leavesOf(fieldsOf(schema), document)
    .filter(([field, value]) => !SHOWN_ELSEWHERE.has(field.name) && !isUsual(field, value))
    .map(([field, value]) => [field.label, inWords(field, value)]);
}

/** Special cases of which this film is none. */
function isUsual({ input, fallback }: Field, value: unknown): boolean {
  return (input.kind === "flag" || input.kind === "number") && value === fallback;
}

export function StackFacts({ experiment }: { experiment: Experiment }) {
  const { stack } = experiment;
  const facts: Fact[] = [
    ["Files", `${formatCount(stack.n_files)}, ${formatBytes(stack.size_bytes)}`],
    ["Group", experiment.group.name],
    ["Created", <Moment key="created" time={experiment.created_at} />],
  ];
  if (stack.n_frames != null) {
    facts.unshift(
      ["Frames", formatCount(stack.n_frames)],
      ["Size", `${stack.columns} × ${stack.rows} px, ${stack.dtype}`],
      ["Duration", formatDuration(stack.duration_s)],
    );
  }
  if (stack.confirmation) facts.push(["Confirmed", confirmedBy(stack.confirmation)]);
  if (stack.broken_frames.length > 0)
    facts.push(["Left out", `${plural(stack.broken_frames.length, "frame")} that cannot be read`]);
  return <Facts facts={facts} label="Stack" />;
}
