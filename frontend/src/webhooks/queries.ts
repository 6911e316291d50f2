import { queryOptions } from "@tanstack/react-query";
import { noticesList, webhooksList } from "../client";

const REFRESH_MS = 3_000;

export function webhooksQuery(group_id: string) {
  return queryOptions({
    queryKey: ["webhooks", group_id],
    queryFn: async ({ signal }) => (await webhooksList({ path: { group_id }, signal })).data,
  });
}

/** What a webhook was told; looked at again as long as something is on its way. */
export function noticesQuery(group_id: string, webhook_id: string) {
  return queryOptions({
    queryKey: ["webhooks", group_id, webhook_id, "notices"],
    queryFn: async ({ signal }) =>
      (await noticesList({ path: { group_id, webhook_id }, query: { limit: 20 }, signal })).data,
    refetchInterval: ({ state }) =>
      state.data?.items.some((notice) => notice.state === "waiting") ? REFRESH_MS : false,
  });
}
