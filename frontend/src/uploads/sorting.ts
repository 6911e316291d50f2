/** Telling apart the files of a drop: frames, the files the experiment names, and what is none of these. */

export type Role = "frames" | "flat_field" | "timestamps" | "temperature_log";
export type NamedRole = Exclude<Role, "frames">;
export const NAMED_ROLES: NamedRole[] = ["flat_field", "timestamps", "temperature_log"];

/** A file and the name under which it is sent: its path inside what was dropped. */
export type Found = { file: File; name: string };

export type Sorted = {
  frames: Found[];
  named: Partial<Record<NamedRole, Found>>;
  description?: Found;
  left_out: string[];
};

const FRAME = /\.(tiff?|png|jpe?g|bmp|zip|avi|mp4|m4v|mov|mkv|webm|h5|hdf5|mat|nd2)$/i;
const DESCRIPTION = /(^|\/)experiment\.(ya?ml|json)$/i;
/** A flat field that lies among the frames would be taken for one of them: its name says what it is. */
const FLAT_FIELD = /^flat[-_ ]?field\.(tiff?|png|jpe?g|bmp)$/i;
/** Files that systems leave behind and nobody misses. */
const LITTER = /(^|\/)(\.[^/]*|__MACOSX\/.*|Thumbs\.db|desktop\.ini)$/i;

export function baseName(name: string): string {
  return name.split("/").at(-1) ?? name;
}

/** The files that a description names, by role. */
export function rolesIn(document: Record<string, unknown>): Partial<Record<NamedRole, string>> {
  return Object.fromEntries(
    NAMED_ROLES.flatMap((role) => {
      const name = document[role];
      return typeof name === "string" && name ? [[role, baseName(name)]] : [];
    }),
  );
}

/** What was dropped, put in order. `roles` are the files that the experiment names. */
export function sortFiles(found: Found[], roles: Partial<Record<NamedRole, string>>): Sorted {
  const sorted: Sorted = { frames: [], named: {}, left_out: [] };
  const isDescribed = found.some(({ name }) => DESCRIPTION.test(name));
  for (const one of found) {
    const name = baseName(one.name);
    const role = NAMED_ROLES.find((candidate) => roles[candidate] === name);
    if (LITTER.test(one.name)) continue;
    if (DESCRIPTION.test(one.name)) sorted.description ??= one;
    else if (role) sorted.named[role] ??= one;
    else if (FLAT_FIELD.test(name) && !isDescribed) sorted.named.flat_field ??= one;
    else if (FRAME.test(name) && !FLAT_FIELD.test(name)) sorted.frames.push(one);
    else sorted.left_out.push(one.name);
  }
  return sorted;
}

export function totalBytes(found: Found[]): number {
  return found.reduce((sum, { file }) => sum + file.size, 0);
}
