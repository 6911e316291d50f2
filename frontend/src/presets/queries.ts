import { queryOptions, useMutation, useQueryClient } from "@tanstack/react-query";
import { type Preset, presetsCreate, presetsDelete, presetsList, presetsUpdate } from "../client";
import { type Document, flatten, withValue } from "../forms/document";

export function presetsQuery(groupId: string) {
  return queryOptions({
    queryKey: ["groups", groupId, "presets"],
    queryFn: async ({ signal }) => (await presetsList({ path: { group_id: groupId }, signal })).data.items,
  });
}

/** Keep parameters under a name: a new preset, or in place of one. */
export function useSavePreset(groupId: string) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: async ({ name, parameters, old }: { name: string; parameters: Document; old?: Preset }) => {
      const body = { name, parameters };
      const path = { group_id: groupId };
      return old
        ? (await presetsUpdate({ path: { ...path, preset_id: old.id }, body })).data
        : (await presetsCreate({ path, body })).data;
    },
    onSuccess: () => cache.invalidateQueries(presetsQuery(groupId)),
  });
}

export function useDeletePreset(groupId: string, presetId: string) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: () => presetsDelete({ path: { group_id: groupId, preset_id: presetId } }),
    onSuccess: () => cache.invalidateQueries(presetsQuery(groupId)),
  });
}

/** What a preset says over the defaults: a knob that came later keeps its default. */
export function parametersOf(preset: Pick<Preset, "parameters">, defaults: Document): Document {
  return Object.entries(flatten(preset.parameters)).reduce(
    (document, [path, value]) => withValue(document, path, value),
    defaults,
  );
}

/** The preset of this name, however it is written. */
export function named(presets: readonly Preset[], name: string): Preset | undefined {
  const wanted = name.trim().toLowerCase();
  return presets.find((preset) => preset.name.toLowerCase() === wanted);
}
