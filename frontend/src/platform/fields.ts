import { labelAndUnit } from "./units";

/** `material.viscosity_pa_s` as "Material, viscosity". */
export function plainField(path: string): string {
  const labels = path.split(".").map((name) => labelAndUnit(name).label);
  return labels.map((label, index) => (index === 0 ? label : label.toLowerCase())).join(", ");
}
