import { Select } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { sessionQuery } from "../people/session";

type GroupChoiceProps = { value: string | null; onChange: (groupId: string) => void };

/** The group that something new belongs to; nothing where there is no choice. */
export function GroupChoice({ value, onChange }: GroupChoiceProps) {
  const { data: session } = useQuery(sessionQuery);
  const groups = (session?.groups ?? []).filter(({ right }) => right !== "view");
  if (groups.length < 2) return null;
  return (
    <Select
      label="Group"
      description="Its members see this experiment, and nobody else does."
      data={groups.map(({ id, name, is_personal }) => ({
        value: id,
        label: is_personal ? `${name} (your own space)` : name,
      }))}
      value={value ?? groups.find(({ is_personal }) => is_personal)?.id ?? groups[0]?.id ?? null}
      allowDeselect={false}
      onChange={(groupId) => groupId && onChange(groupId)}
    />
  );
}
