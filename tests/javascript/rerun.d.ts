/* What `run.py live` puts beside the book: files as scripts, and who takes what they hand over. */

interface LiveFile {
  name: string;
  part: string;
  script: string;
  bytes: number;
  needs?: string[];
}

interface Window {
  rerunFiles: { folder: string; files: LiveFile[] } | null;
  rerunTake: (name: string, text: string) => void;
}
