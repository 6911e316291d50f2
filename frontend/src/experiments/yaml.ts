import { type Document, isMapping } from "../forms/document";

/** Read `experiment.yaml` (or JSON, which is YAML). The parser comes with its first use. */
export async function readYaml(text: string): Promise<Document> {
  const { parse } = await import("yaml");
  let content: unknown;
  try {
    content = parse(text);
  } catch (error) {
    const [reason] = (error as Error).message.split("\n");
    throw new Error(`This is not valid YAML: ${reason}`);
  }
  if (!isMapping(content))
    throw new Error("This is no experiment.yaml: expected lines such as “pixel_size_um: 0.625”.");
  return withoutEmpty(content);
}

function withoutEmpty(document: Document): Document {
  return Object.fromEntries(Object.entries(document).filter(([, value]) => value !== null));
}
