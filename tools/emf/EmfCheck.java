// The judgement of the Eclipse Modeling Framework (EMF) on metamodels and models, outside Eclipse.
//
//   EmfCheck [--map FROM TO]... [--dump] [--resave FILE] FILE...
//
// Metamodels come first, models of them after. One line is printed for each finding, `ERROR file:
// place: message` or `WARNING ...`. Where there is no ERROR, --dump prints one line for each object
// of the models, `OBJECT file#fragment: class feature=value ...`, and --resave saves the last file
// as Eclipse would. --map reads URIs that start with FROM as if they started with TO.
// Ends with 0, with 1 after an ERROR, with 2 when it is called wrongly.

import java.io.File;
import java.io.IOException;
import java.io.InputStream;
import java.nio.file.Path;
import java.util.ArrayList;
import java.util.IdentityHashMap;
import java.util.Iterator;
import java.util.LinkedHashSet;
import java.util.List;
import java.util.Map;
import java.util.Set;
import java.util.stream.Collectors;
import org.eclipse.emf.common.util.Diagnostic;
import org.eclipse.emf.common.util.URI;
import org.eclipse.emf.ecore.EDataType;
import org.eclipse.emf.ecore.EObject;
import org.eclipse.emf.ecore.EPackage;
import org.eclipse.emf.ecore.EReference;
import org.eclipse.emf.ecore.EStructuralFeature;
import org.eclipse.emf.ecore.EcorePackage;
import org.eclipse.emf.ecore.InternalEObject;
import org.eclipse.emf.ecore.resource.Resource;
import org.eclipse.emf.ecore.resource.ResourceSet;
import org.eclipse.emf.ecore.resource.impl.ResourceSetImpl;
import org.eclipse.emf.ecore.resource.impl.URIHandlerImpl;
import org.eclipse.emf.ecore.util.Diagnostician;
import org.eclipse.emf.ecore.util.EcoreUtil;
import org.eclipse.emf.ecore.xmi.XMLLoad;
import org.eclipse.emf.ecore.xmi.XMLResource;
import org.eclipse.emf.ecore.xmi.impl.SAXXMIHandler;
import org.eclipse.emf.ecore.xmi.impl.XMILoadImpl;
import org.eclipse.emf.ecore.xmi.impl.XMIResourceImpl;
import org.xml.sax.helpers.DefaultHandler;

public final class EmfCheck {
  private final ResourceSet documents = new ResourceSetImpl();
  private final Map<EObject, Integer> lines = new IdentityHashMap<>();
  private final Set<String> findings = new LinkedHashSet<>();

  public static void main(String[] arguments) throws IOException {
    EmfCheck check = new EmfCheck();
    List<Path> files = new ArrayList<>();
    Path resaved = null;
    boolean dump = false;
    Iterator<String> rest = List.of(arguments).iterator();
    while (rest.hasNext()) {
      String argument = rest.next();
      switch (argument) {
        case "--map" -> check.map(rest.next(), rest.next());
        case "--resave" -> resaved = Path.of(rest.next());
        case "--dump" -> dump = true;
        default -> files.add(Path.of(argument));
      }
    }
    if (files.isEmpty() || arguments[arguments.length - 1].startsWith("--")) {
      System.err.println("usage: EmfCheck [--map FROM TO]... [--dump] [--resave FILE] FILE...");
      System.exit(2);
    }
    Resource last = check.judge(files);
    check.findings.forEach(System.out::println);
    if (check.findings.stream().anyMatch(line -> line.startsWith("ERROR"))) {
      System.exit(1);
    }
    if (dump) {
      check.dump();
    }
    if (resaved != null) {
      last.setURI(uri(resaved));
      last.save(Map.of());
    }
  }

  private EmfCheck() {
    // Outside Eclipse no plug-in registers the metametamodel and what reads files.
    documents.getPackageRegistry().put(EcorePackage.eNS_URI, EcorePackage.eINSTANCE);
    Map<String, Object> factories =
        documents.getResourceFactoryRegistry().getExtensionToFactoryMap();
    factories.put(
        Resource.Factory.Registry.DEFAULT_EXTENSION, (Resource.Factory) LocatedResource::new);
    // In front of the handler that fetches: what is no file is an error, not a download.
    List<org.eclipse.emf.ecore.resource.URIHandler> handlers =
        documents.getURIConverter().getURIHandlers();
    handlers.add(handlers.size() - 1, new FilesAlone());
  }

  private void map(String from, String to) {
    URI target = uri(Path.of(to));
    URI folder = to.endsWith(File.separator) ? target.appendSegment("") : target;
    documents.getURIConverter().getURIMap().put(URI.createURI(from), folder);
  }

  /** Loads all files, resolves what they refer to and validates it; returns the last file. */
  private Resource judge(List<Path> files) {
    Resource last = null;
    for (Path file : files) {
      last = load(uri(file));
      if (isMetamodel(last)) {
        last.getContents().forEach(this::register);
      }
    }
    try {
      EcoreUtil.resolveAll(documents);
    } catch (RuntimeException failure) {
      find("ERROR", "-", "a reference cannot be resolved: " + failure.getMessage());
    }
    List<Resource> all = List.copyOf(documents.getResources());
    for (Resource document : all) {
      document.getErrors().forEach(each -> findWhileReading("ERROR", document, each));
      document.getWarnings().forEach(each -> findWhileReading("WARNING", document, each));
    }
    for (Resource document : all) {
      for (EObject root : List.copyOf(document.getContents())) {
        validate(root, document);
      }
    }
    return last;
  }

  private Resource load(URI uri) {
    try {
      return documents.getResource(uri, true);
    } catch (RuntimeException failure) {
      // Most often the document keeps the reason among its errors.
      Resource document = documents.getResource(uri, false);
      if (document == null || document.getErrors().isEmpty()) {
        Throwable cause = failure.getCause() == null ? failure : failure.getCause();
        find("ERROR", display(uri), String.valueOf(cause.getMessage()));
      }
      return document == null ? documents.createResource(uri) : document;
    }
  }

  private void register(EObject root) {
    if (root instanceof EPackage found) {
      documents.getPackageRegistry().put(found.getNsURI(), found);
      found.getESubpackages().forEach(this::register);
    }
  }

  private void validate(EObject root, Resource document) {
    Diagnostician judge =
        new Diagnostician() {
          @Override
          public String getObjectLabel(EObject object) {
            return label(object);
          }
        };
    try {
      for (Diagnostic each : judge.validate(root).getChildren()) {
        findInvalid(each, named(each, root), "", document);
      }
    } catch (RuntimeException failure) {
      find("ERROR", display(document.getURI()), place(root) + "validation fails: " + failure);
    }
  }

  /** Reports what is wrong with an object, once for each of the reasons that EMF gives. */
  private void findInvalid(Diagnostic found, EObject object, String reason, Resource document) {
    if (found.getChildren().isEmpty()) {
      Resource owner = object.eResource() == null ? document : object.eResource();
      String severity = found.getSeverity() >= Diagnostic.ERROR ? "ERROR" : "WARNING";
      find(severity, display(owner.getURI()), place(object) + reason + found.getMessage());
    }
    for (Diagnostic each : found.getChildren()) {
      findInvalid(each, object, reason + found.getMessage() + ": ", document);
    }
  }

  /** The object that a diagnostic is about: the first of those that it names. */
  private static EObject named(Diagnostic found, EObject root) {
    return found.getData().stream()
        .filter(EObject.class::isInstance)
        .map(EObject.class::cast)
        .findFirst()
        .orElse(root);
  }

  private void findWhileReading(String severity, Resource document, Resource.Diagnostic found) {
    String text = found.getMessage();
    if (found instanceof Exception failure && failure.getCause() != null) {
      text = failure.getCause().getMessage();
    }
    // EMF ends its messages with the place, which stands in front here.
    text = String.valueOf(text).replaceFirst(" \\(file:[^()]*\\)$", "");
    String place =
        lineOf(found) > 0 ? "line " + lineOf(found) + ", column " + found.getColumn() + ": " : "";
    find(severity, display(document.getURI()), place + text);
  }

  /** The line of a problem; an error that wraps another than the parser's has none. */
  private static int lineOf(Resource.Diagnostic found) {
    try {
      return found.getLine();
    } catch (RuntimeException none) {
      return 0;
    }
  }

  private void find(String severity, String file, String message) {
    findings.add(severity + " " + file + ": " + onOneLine(message));
  }

  private void dump() {
    for (Resource document : documents.getResources()) {
      if (isMetamodel(document)) {
        continue;
      }
      document
          .getAllContents()
          .forEachRemaining(
              each ->
                  System.out.println(
                      onOneLine("OBJECT " + address(each) + ": " + described(each, document))));
    }
  }

  private static String described(EObject object, Resource document) {
    String values =
        object.eClass().getEAllStructuralFeatures().stream()
            .filter(EmfCheck::isShown)
            .map(feature -> " " + feature.getName() + "=" + shown(object, feature, document))
            .collect(Collectors.joining());
    EPackage home = object.eClass().getEPackage();
    return home.getName() + "." + object.eClass().getName() + values;
  }

  /** Whether a feature is the object's own: contained objects have lines of their own. */
  private static boolean isShown(EStructuralFeature feature) {
    boolean owns =
        feature instanceof EReference reference
            && (reference.isContainment() || reference.isContainer());
    return !feature.isDerived() && !owns;
  }

  private static String shown(EObject object, EStructuralFeature feature, Resource document) {
    Object value = object.eGet(feature);
    if (value instanceof List<?> several) {
      return several.stream()
          .map(each -> shown(each, feature, document))
          .collect(Collectors.joining(", ", "[", "]"));
    }
    return shown(value, feature, document);
  }

  private static String shown(Object value, EStructuralFeature feature, Resource document) {
    if (value == null) {
      return "null";
    }
    if (value instanceof EObject target && feature instanceof EReference) {
      if (target.eIsProxy()) {
        return "unresolved " + ((InternalEObject) target).eProxyURI();
      }
      return target.eResource() == document ? "#" + fragment(target) : address(target);
    }
    return '"' + EcoreUtil.convertToString((EDataType) feature.getEType(), value) + '"';
  }

  private String place(EObject object) {
    Integer line = lines.get(object);
    return (line == null ? "" : "line " + line + ", ") + fragment(object) + ": ";
  }

  private static String label(EObject object) {
    if (object.eIsProxy()) {
      return String.valueOf(((InternalEObject) object).eProxyURI());
    }
    EStructuralFeature name = object.eClass().getEStructuralFeature("name");
    Object said = name == null ? null : object.eGet(name);
    return object.eClass().getName() + (said == null ? "" : " '" + said + "'");
  }

  private static String address(EObject object) {
    Resource document = object.eResource();
    return (document == null ? "" : display(document.getURI())) + "#" + fragment(object);
  }

  private static String fragment(EObject object) {
    return object.eResource() == null ? "" : object.eResource().getURIFragment(object);
  }

  private static boolean isMetamodel(Resource document) {
    return !document.getContents().isEmpty() && document.getContents().get(0) instanceof EPackage;
  }

  private static URI uri(Path file) {
    return URI.createFileURI(file.toAbsolutePath().normalize().toString());
  }

  /** A file as seen from the current folder, where it lies below that. */
  private static String display(URI uri) {
    if (!uri.isFile()) {
      return uri.toString();
    }
    Path here = Path.of("").toAbsolutePath();
    Path file = Path.of(uri.toFileString());
    return (file.startsWith(here) ? here.relativize(file) : file).toString();
  }

  private static String onOneLine(String text) {
    return text.lines().map(String::strip).collect(Collectors.joining(" "));
  }

  /** A document that notes where each object stands, and lets no entity in. */
  private final class LocatedResource extends XMIResourceImpl {
    LocatedResource(URI uri) {
      super(uri);
      setEncoding("UTF-8"); // what Eclipse's editors write
      getDefaultLoadOptions()
          .put(
              XMLResource.OPTION_PARSER_FEATURES,
              Map.of("http://apache.org/xml/features/disallow-doctype-decl", true));
    }

    @Override
    protected XMLLoad createXMLLoad() {
      return new XMILoadImpl(createXMLHelper()) {
        @Override
        protected DefaultHandler makeDefaultHandler() {
          return new SAXXMIHandler(resource, helper, options) {
            @Override
            protected void processObject(EObject object) {
              if (object != null) {
                lines.put(object, getLineNumber());
              }
              super.processObject(object);
            }
          };
        }
      };
    }
  }

  /** Stands for every scheme but files: nothing is fetched. */
  private static final class FilesAlone extends URIHandlerImpl {
    @Override
    public boolean canHandle(URI uri) {
      return !uri.isFile();
    }

    @Override
    public InputStream createInputStream(URI uri, Map<?, ?> options) throws IOException {
      throw new IOException("no file: " + uri);
    }
  }
}
