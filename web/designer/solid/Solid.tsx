export default function Solid() {
  return <section className="solid" aria-label="The crane in three dimensions" />;
}
