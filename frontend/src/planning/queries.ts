import { keepPreviousData, queryOptions } from "@tanstack/react-query";
import {
  materialsGet,
  materialsGetPhaseDiagram,
  materialsGetViscosity,
  materialsList,
  rampsGet,
} from "../client";
import type { RampWish } from "./wish";

export const materialsQuery = queryOptions({
  queryKey: ["materials"],
  queryFn: async ({ signal }) => (await materialsList({ signal })).data.items,
  staleTime: Number.POSITIVE_INFINITY,
});

export function materialQuery(name: string, temperature_c: number | undefined) {
  return queryOptions({
    queryKey: ["materials", name, temperature_c],
    queryFn: async ({ signal }) =>
      (await materialsGet({ path: { name }, query: { temperature_c }, signal })).data,
    placeholderData: keepPreviousData,
  });
}

export function materialFigureQuery(name: string, figure: "phase_diagram" | "viscosity") {
  const ask = figure === "viscosity" ? materialsGetViscosity : materialsGetPhaseDiagram;
  return queryOptions({
    queryKey: ["materials", name, "figures", figure],
    queryFn: async ({ signal }) => (await ask({ path: { name }, signal })).data,
    staleTime: Number.POSITIVE_INFINITY,
  });
}

export function rampQuery(name: string, wish: RampWish) {
  return queryOptions({
    queryKey: ["materials", name, "ramp", wish],
    queryFn: async ({ signal }) => (await rampsGet({ path: { name }, query: wish, signal })).data,
    placeholderData: keepPreviousData,
    retry: false,
  });
}
