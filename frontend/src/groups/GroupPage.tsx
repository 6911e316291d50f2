import { Anchor, Button, Group, Select, Stack, Table, Text } from "@mantine/core";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { Link, useParams } from "@tanstack/react-router";
import { useState } from "react";
import {
  invitationsCreate,
  invitationsDelete,
  type Member,
  membersRemove,
  membersSet,
  type OwnGroup,
  type Right,
} from "../client";
import { Once } from "../people/Once";
import { sessionQuery } from "../people/session";
import { ConfirmButton } from "../platform/ConfirmButton";
import { Moment } from "../platform/Moment";
import { Page } from "../platform/Page";
import { Panel } from "../platform/Panel";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { QueryView } from "../platform/QueryView";
import { Webhooks } from "../webhooks/Webhooks";
import { LimitsForm } from "./LimitsForm";
import { groupQuery, invitationsQuery, membersQuery } from "./queries";
import { UsageBar } from "./UsageBar";

const RIGHTS: { value: Right; label: string }[] = [
  { value: "view", label: "view" },
  { value: "edit", label: "edit" },
  { value: "manage", label: "manage" },
];

/** One group: who is in it, who is invited, what it uses. */
export function GroupPage() {
  const { groupId } = useParams({ from: "/groups/$groupId" });
  const group = useQuery(groupQuery(groupId));
  const session = useQuery(sessionQuery);
  return (
    <QueryView query={group}>
      {(found) => {
        const mayManage = found.right === "manage" || session.data?.person?.is_administrator === true;
        return (
          <Page
            title={found.name}
            above={[
              <Anchor key="groups" renderRoot={(props) => <Link to="/groups" {...props} />}>
                Groups
              </Anchor>,
            ]}
          >
            <Panel title="Room">
              <UsageBar usage={found.usage} />
              {session.data?.person?.is_administrator && !session.data.is_local && (
                <LimitsForm key={found.id} group={found} />
              )}
            </Panel>
            {found.is_personal ? (
              <Text fz="sm">This is your own space: nobody else sees what is in it.</Text>
            ) : (
              <>
                <Members group={found} mayManage={mayManage} ownId={session.data?.person?.id} />
                {mayManage && <Invitations groupId={found.id} />}
              </>
            )}
            {mayManage && <Webhooks groupId={found.id} />}
          </Page>
        );
      }}
    </QueryView>
  );
}

type MembersProps = { group: OwnGroup; mayManage: boolean; ownId: string | undefined };

function Members({ group, mayManage, ownId }: MembersProps) {
  const members = useQuery(membersQuery(group.id));
  return (
    <Panel
      title="Members"
      about="View: look and download. Edit: also upload, analyse and delete. Manage: also decide who is in."
    >
      <QueryView query={members}>
        {({ items }) => (
          <Table>
            <Table.Tbody>
              {items.map((member) => (
                <MemberRow
                  key={member.person_id}
                  groupId={group.id}
                  member={member}
                  mayManage={mayManage}
                  isSelf={member.person_id === ownId}
                />
              ))}
            </Table.Tbody>
          </Table>
        )}
      </QueryView>
    </Panel>
  );
}

type MemberRowProps = { groupId: string; member: Member; mayManage: boolean; isSelf: boolean };

function MemberRow({ groupId, member, mayManage, isSelf }: MemberRowProps) {
  const cache = useQueryClient();
  const path = { group_id: groupId, person_id: member.person_id };
  const onSuccess = () => cache.invalidateQueries({ queryKey: ["groups"] });
  const change = useMutation({
    mutationFn: (right: Right) => membersSet({ path, body: { right } }),
    onSuccess,
  });
  const remove = useMutation({ mutationFn: () => membersRemove({ path }), onSuccess });
  return (
    <Table.Tr>
      <Table.Td>
        {member.name}{" "}
        <Text span c="dimmed" fz="sm">
          {member.email}
        </Text>
      </Table.Td>
      <Table.Td w={160}>
        {mayManage ? (
          <Select
            aria-label={`What ${member.name} may do`}
            data={RIGHTS}
            value={member.right}
            allowDeselect={false}
            disabled={change.isPending}
            onChange={(right) => right && change.mutate(right as Right)}
          />
        ) : (
          member.right
        )}
        {change.error && (
          <Text c="red" fz="sm" role="alert">
            {toProblem(change.error).detail}
          </Text>
        )}
      </Table.Td>
      <Table.Td w={120}>
        {(mayManage || isSelf) && (
          <ConfirmButton
            label={isSelf ? "Leave" : "Remove"}
            size="xs"
            title={isSelf ? "Leave this group?" : `Remove ${member.name}?`}
            action={isSelf ? "Leave it" : "Remove them"}
            mutation={remove}
          >
            {isSelf ? "You will" : "They will"} see nothing of this group any more. What was made stays.
          </ConfirmButton>
        )}
      </Table.Td>
    </Table.Tr>
  );
}

function Invitations({ groupId }: { groupId: string }) {
  const cache = useQueryClient();
  const invitations = useQuery(invitationsQuery(groupId));
  const [right, setRight] = useState<Right>("edit");
  const refresh = () => cache.invalidateQueries({ queryKey: invitationsQuery(groupId).queryKey });
  const invite = useMutation({
    mutationFn: async () =>
      (await invitationsCreate({ path: { group_id: groupId }, body: { right, days: 7 } })).data,
    onSuccess: refresh,
  });
  const takeBack = useMutation({
    mutationFn: (invitation_id: string) => invitationsDelete({ path: { group_id: groupId, invitation_id } }),
    onSuccess: refresh,
  });
  return (
    <Panel
      title="Invite"
      about="A link lets one person in, within seven days; without an account they make one."
    >
      <Stack gap="sm">
        <Group align="flex-end">
          <Select
            label="They may"
            data={RIGHTS}
            value={right}
            allowDeselect={false}
            onChange={(value) => value && setRight(value as Right)}
          />
          <Button onClick={() => invite.mutate()} loading={invite.isPending}>
            Make a link
          </Button>
        </Group>
        {invite.error && <ProblemAlert problem={toProblem(invite.error)} />}
        {invite.data && (
          <Once
            label="Invitation"
            value={invite.data.link}
            about="Send it to one person. It is not shown again."
          />
        )}
        {invitations.data && invitations.data.items.length > 0 && (
          <Table>
            <Table.Tbody>
              {invitations.data.items.map((invitation) => (
                <Table.Tr key={invitation.id}>
                  <Table.Td>
                    To {invitation.right}, made <Moment time={invitation.created_at} isShort />
                  </Table.Td>
                  <Table.Td w={120}>
                    <Button size="xs" variant="default" onClick={() => takeBack.mutate(invitation.id)}>
                      Take back
                    </Button>
                  </Table.Td>
                </Table.Tr>
              ))}
            </Table.Tbody>
          </Table>
        )}
      </Stack>
    </Panel>
  );
}
