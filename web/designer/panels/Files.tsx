import { useBench } from "../context";
import { DESIGN_FILE, FRONT_FILE, openDesign } from "../files";

/** The inputs of files that can be opened wherever one is in the page. */
export function Files() {
  const { designer, search } = useBench();
  return (
    <>
      <FileInput id={DESIGN_FILE} test="file" accept=".json,.zip" onChoose={(file) => openDesign(designer, file)} />
      <FileInput id={FRONT_FILE} test="front-file" accept=".json" onChoose={(file) => search.open(file)} />
    </>
  );
}

interface Props {
  id: string;
  test: string;
  accept: string;
  onChoose: (file: File) => void;
}

export function FileInput({ id, test, accept, onChoose }: Props) {
  return (
    <input
      id={id}
      type="file"
      accept={accept}
      hidden
      data-testid={test}
      onChange={(event) => {
        const chosen = event.currentTarget.files?.[0];
        event.currentTarget.value = "";
        if (chosen) onChoose(chosen);
      }}
    />
  );
}
