import { useState } from "react";
import { check } from "../forms/check";
import { type Document, defaultsOf, withValue } from "../forms/document";
import type { Field } from "../forms/schema";
import { baseName, type Found, type NamedRole, rolesIn, type Sorted, sortFiles } from "../uploads/sorting";
import { readYaml } from "./yaml";

/** What a new experiment will be: its description and the files chosen for it. */
export function useDraft(fields: Field[]) {
  const [document, setDocument] = useState<Document>(() => defaultsOf(fields));
  const [files, setFiles] = useState<Found[]>([]);
  const [notice, setNotice] = useState<string | null>(null);
  const sorted = sortFiles(files, rolesIn(document));

  const describe = (from: Document) => setDocument({ ...defaultsOf(fields), ...from });

  const addFiles = async (found: Found[]) => {
    setFiles(merged(files, found));
    const { description, named } = sortFiles(found, rolesIn(document));
    if (description) {
      try {
        describe(await readYaml(await description.file.text()));
        setNotice(`The form was filled from ${description.name}.`);
      } catch (error) {
        setNotice(`${description.name} could not be read. ${(error as Error).message}`);
      }
    } else if (named.flat_field && document.flat_field === undefined) {
      setDocument(withValue(document, "flat_field", baseName(named.flat_field.name)));
    }
  };

  const chooseNamed = (role: NamedRole, found: Found) => {
    setFiles(merged(withoutNamed(files, sorted, role), [found]));
    const described = withValue(document, role, baseName(found.name));
    setDocument(role === "timestamps" ? withValue(described, "frame_interval_s", undefined) : described);
  };

  const removeNamed = (role: NamedRole) => {
    setFiles(withoutNamed(files, sorted, role));
    setDocument(withValue(document, role, undefined));
  };

  const clearFrames = () => setFiles(Object.values(sorted.named));

  return { document, setDocument, describe, sorted, notice, addFiles, chooseNamed, removeNamed, clearFrames };
}

/** Later files take the place of earlier ones of the same name. */
function merged(files: Found[], more: Found[]): Found[] {
  const names = new Set(more.map(({ name }) => name));
  return [...files.filter(({ name }) => !names.has(name)), ...more];
}

function withoutNamed(files: Found[], sorted: Sorted, role: NamedRole): Found[] {
  return files.filter((one) => one !== sorted.named[role]);
}

/** Messages by field: the schema's, and what a schema cannot say. */
export function checkDraft(fields: Field[], document: Document, sorted: Sorted): Record<string, string> {
  const messages = check(fields, document);
  const hasInterval = document.frame_interval_s !== undefined;
  const hasTimestamps = document.timestamps !== undefined;
  if (!hasInterval && !hasTimestamps)
    messages.frame_interval_s = "Give the time between frames, or a timestamps file.";
  if (hasInterval && hasTimestamps)
    messages.timestamps = "Give either a timestamps file or the frame interval.";
  for (const [role, name] of Object.entries(rolesIn(document))) {
    if (!sorted.named[role as NamedRole])
      messages[role] ??= `The description names ${name}: add this file, or take it out.`;
  }
  return messages;
}
