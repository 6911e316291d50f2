import { useEffect, useRef, useState } from "react";

/** A JPEG in base64 as a picture. */
export function usePicture(jpeg: string | null | undefined): ImageBitmap | null {
  const [picture, setPicture] = useState<ImageBitmap | null>(null);
  const wanted = useRef<string | null>(null);
  useEffect(() => {
    wanted.current = jpeg ?? null;
    if (!jpeg) return setPicture(null);
    void pictureFrom(jpeg).then((made) => {
      if (wanted.current === jpeg) setPicture(made);
    });
  }, [jpeg]);
  return picture;
}

export function pictureFrom(jpeg: string): Promise<ImageBitmap> {
  const bytes = Uint8Array.from(atob(jpeg), (character) => character.charCodeAt(0));
  return createImageBitmap(new Blob([bytes], { type: "image/jpeg" }));
}
