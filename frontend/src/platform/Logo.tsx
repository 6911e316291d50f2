/** Three droplets: one seen as a circle, two rising away from it. */
export function Logo({ size = 26 }: { size?: number }) {
  return (
    <svg width={size} height={size} viewBox="0 0 32 32" aria-hidden="true" focusable="false">
      <circle cx="13" cy="19" r="9.5" fill="none" stroke="currentColor" strokeWidth="2.6" />
      <circle cx="24.5" cy="8" r="5" fill="currentColor" />
      <circle cx="10" cy="4.8" r="2.4" fill="currentColor" />
    </svg>
  );
}
