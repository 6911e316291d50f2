import { Text, VisuallyHidden } from "@mantine/core";
import { formatNumber } from "../platform/format";
import { Prose } from "../platform/Prose";
import type { Field } from "./schema";

/** The label; its unit stands at the end of the input, and in the label only for those who hear it. */
export function Label({ field }: { field: Field }) {
  return (
    <>
      {field.label}
      {field.unit && <VisuallyHidden> ({field.unit})</VisuallyHidden>}
    </>
  );
}

/** What a field means, and what the paper takes for it. */
export function Help({ field }: { field: Field }) {
  const { paper } = field;
  if (!field.help && !paper) return null;
  return (
    <>
      {field.help && <Prose text={field.help} />}
      {paper && (
        <>
          {" "}
          <Text span fz="inherit" style={{ whiteSpace: "nowrap" }}>
            Paper: {typeof paper.value === "number" ? formatNumber(paper.value) : String(paper.value)}
            {field.unit && ` ${field.unit}`}
            {paper.section && ` (section ${paper.section})`}.
          </Text>
        </>
      )}
    </>
  );
}
