import { queryOptions } from "@tanstack/react-query";
import { groupsGet, groupsList, invitationsList, membersList } from "../client";

export const groupsQuery = queryOptions({
  queryKey: ["groups"],
  queryFn: async ({ signal }) => (await groupsList({ signal })).data,
});

export function groupQuery(group_id: string) {
  return queryOptions({
    queryKey: ["groups", group_id],
    queryFn: async ({ signal }) => (await groupsGet({ path: { group_id }, signal })).data,
  });
}

export function membersQuery(group_id: string) {
  return queryOptions({
    queryKey: ["groups", group_id, "members"],
    queryFn: async ({ signal }) => (await membersList({ path: { group_id }, signal })).data,
  });
}

export function invitationsQuery(group_id: string) {
  return queryOptions({
    queryKey: ["groups", group_id, "invitations"],
    queryFn: async ({ signal }) => (await invitationsList({ path: { group_id }, signal })).data,
  });
}
