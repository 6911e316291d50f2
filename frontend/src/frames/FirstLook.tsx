import { Alert, Anchor, Checkbox, Group, Image, List, SimpleGrid, Stack, Text } from "@mantine/core";
import { Link } from "@tanstack/react-router";
import { useState } from "react";
import type { Experiment } from "../client";
import { formatCount, formatDuration, formatNumber, plural } from "../platform/format";
import { confirmedBy } from "./confirmed";
import { pictureUrl } from "./pictures";
import { frameSource, useStamp } from "./source";

const SIDE_PX = 600;

type FirstLookProps = { experiment: Experiment; isRefused: boolean; onRight: () => void };

/** The first frames and the last, their numbering and their scale, for a person to say that this is their film. */
export function FirstLook({ experiment, isRefused, onRight }: FirstLookProps) {
  const source = frameSource(experiment);
  const stamp = useStamp(experiment);
  // The tick stands from the click on, not only once the server has it.
  const [isSaid, setSaid] = useState(false);
  if (!source) return null;
  const { stack } = experiment;
  const isRight = stack.confirmation != null || (isSaid && !isRefused);
  const shown = [...new Set([0, Math.min(1, source.n_frames - 1), source.n_frames - 1])];
  const [width_um, height_um] = [source.columns, source.rows].map(
    (side_px) => side_px * source.pixel_size_um,
  );
  return (
    <Stack gap="sm">
      <SimpleGrid cols={{ base: 1, xs: shown.length }} spacing="xs">
        {shown.map((frame) => (
          <figure key={frame} style={{ margin: 0 }}>
            <Image
              src={pictureUrl(source, frame, SIDE_PX)}
              alt={`Frame ${frame}`}
              mah={260}
              fit="contain"
              loading="lazy"
            />
            <Text component="figcaption" fz="xs" c="dimmed" className="numbers">
              Frame {formatCount(frame)}
              {frame > 0 && frame === source.n_frames - 1 && ", the last"}
              {stamp(frame) && `, ${stamp(frame)}`}
            </Text>
          </figure>
        ))}
      </SimpleGrid>
      <Text fz="sm" className="numbers">
        {plural(source.n_frames, "frame")} of {source.columns} × {source.rows} pixels,{" "}
        {formatNumber(width_um)} × {formatNumber(height_um)} µm at {formatNumber(source.pixel_size_um)} µm a
        pixel
        {stack.duration_s != null && `, over ${formatDuration(stack.duration_s)} with the gaps in it`}.
      </Text>
      {stack.warnings.length > 0 && (
        <Alert color="orange" p="xs" title="Found while they were read">
          <List size="sm">
            {stack.warnings.map((warning) => (
              <List.Item key={warning}>{warning}</List.Item>
            ))}
          </List>
        </Alert>
      )}
      <Group gap="md">
        <Checkbox
          checked={isRight}
          onChange={() => {
            if (isRight) return;
            setSaid(true);
            onRight();
          }}
          label="Order, times and scale are right"
          description={stack.confirmation && `Kept with the frames: ${confirmedBy(stack.confirmation)}`}
        />
        <Anchor
          fz="sm"
          renderRoot={(props) => (
            <Link to="/experiments/$experimentId" params={{ experimentId: experiment.id }} {...props} />
          )}
        >
          Correct them
        </Anchor>
      </Group>
    </Stack>
  );
}
