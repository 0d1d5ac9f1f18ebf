// A picture of a model as the tree editor of Eclipse shows it: the labels and properties are those
// of EMF.Edit, the widgets those of SWT, without the workbench around them.
//
//   EmfPicture PICTURE.png CHOSEN METAMODEL.ecore... MODEL.xmi
//
// CHOSEN is the label of the element whose properties are shown. Needs a display (Xvfb will do) and
// the Debian packages default-jdk-headless, libeclipse-emf-edit-java and libswt-gtk-4-java.

import java.io.IOException;
import java.nio.file.Path;
import java.util.List;
import org.eclipse.emf.common.util.Enumerator;
import org.eclipse.emf.common.util.URI;
import org.eclipse.emf.ecore.EPackage;
import org.eclipse.emf.ecore.resource.Resource;
import org.eclipse.emf.ecore.resource.ResourceSet;
import org.eclipse.emf.ecore.resource.impl.ResourceSetImpl;
import org.eclipse.emf.ecore.xmi.impl.XMIResourceFactoryImpl;
import org.eclipse.emf.edit.provider.IItemLabelProvider;
import org.eclipse.emf.edit.provider.IItemPropertyDescriptor;
import org.eclipse.emf.edit.provider.IItemPropertySource;
import org.eclipse.emf.edit.provider.ITreeItemContentProvider;
import org.eclipse.emf.edit.provider.ReflectiveItemProviderAdapterFactory;
import org.eclipse.swt.SWT;
import org.eclipse.swt.custom.SashForm;
import org.eclipse.swt.graphics.GC;
import org.eclipse.swt.graphics.Image;
import org.eclipse.swt.graphics.ImageData;
import org.eclipse.swt.graphics.ImageLoader;
import org.eclipse.swt.layout.FillLayout;
import org.eclipse.swt.widgets.Display;
import org.eclipse.swt.widgets.Shell;
import org.eclipse.swt.widgets.Table;
import org.eclipse.swt.widgets.TableColumn;
import org.eclipse.swt.widgets.TableItem;
import org.eclipse.swt.widgets.Tree;
import org.eclipse.swt.widgets.TreeItem;

public final class EmfPicture {
  private static final int WIDTH = 1000;
  private static final int HEIGHT = 480;

  private final ReflectiveItemProviderAdapterFactory providers =
      new ReflectiveItemProviderAdapterFactory();
  private final String chosen;
  private final StringBuilder seen = new StringBuilder();
  private Object shown;

  private EmfPicture(String chosen) {
    this.chosen = chosen;
  }

  public static void main(String[] arguments) throws IOException {
    List<String> files = List.of(arguments).subList(2, arguments.length);
    new EmfPicture(arguments[1]).draw(load(files), arguments[0]);
  }

  private static Resource load(List<String> files) throws IOException {
    ResourceSet documents = new ResourceSetImpl();
    documents
        .getResourceFactoryRegistry()
        .getExtensionToFactoryMap()
        .put("*", new XMIResourceFactoryImpl());
    Resource last = null;
    for (String file : files) {
      URI place = URI.createFileURI(Path.of(file).toRealPath().toString());
      last = documents.getResource(place, true);
      if (last.getContents().get(0) instanceof EPackage metamodel) {
        documents.getPackageRegistry().put(metamodel.getNsURI(), metamodel);
      }
    }
    return last;
  }

  private void draw(Resource model, String picture) {
    Display display = new Display();
    Shell shell = new Shell(display, SWT.NO_TRIM);
    shell.setLayout(new FillLayout());
    SashForm halves = new SashForm(shell, SWT.HORIZONTAL);
    Tree tree = new Tree(halves, SWT.BORDER | SWT.SINGLE);
    for (Object root : model.getContents()) {
      add(new TreeItem(tree, SWT.NONE), root, tree);
    }
    Table table = new Table(halves, SWT.BORDER);
    table.setHeaderVisible(true);
    table.setLinesVisible(true);
    for (String title : List.of("Property", "Value")) {
      TableColumn column = new TableColumn(table, SWT.LEFT);
      column.setText(title);
      column.setWidth(title.equals("Value") ? 320 : 170);
    }
    if (shown == null) {
      throw new IllegalArgumentException(chosen + " is none of" + seen);
    }
    IItemPropertySource source =
        (IItemPropertySource) providers.adapt(shown, IItemPropertySource.class);
    for (IItemPropertyDescriptor property : source.getPropertyDescriptors(shown)) {
      Object value = property.getPropertyValue(shown);
      String text = value == null ? "" : text(property, value);
      new TableItem(table, SWT.NONE)
          .setText(new String[] {property.getDisplayName(shown), text});
    }
    halves.setWeights(new int[] {48, 52});
    shell.setSize(WIDTH, HEIGHT);
    shell.open();
    expand(tree.getItems());
    display.timerExec(1500, () -> save(shell, picture));
    while (!shell.isDisposed()) {
      if (!display.readAndDispatch()) {
        display.sleep();
      }
    }
    display.dispose();
  }

  private void add(TreeItem item, Object element, Tree tree) {
    IItemLabelProvider labels =
        (IItemLabelProvider) providers.adapt(element, IItemLabelProvider.class);
    item.setText(labels.getText(element));
    seen.append("\n").append(item.getText());
    if (item.getText().equals(chosen)) {
      shown = element;
      tree.setSelection(item);
    }
    ITreeItemContentProvider children =
        (ITreeItemContentProvider) providers.adapt(element, ITreeItemContentProvider.class);
    for (Object child : children.getChildren(element)) {
      add(new TreeItem(item, SWT.NONE), child, tree);
    }
  }

  private String text(IItemPropertyDescriptor property, Object value) {
    Object bare =
        value instanceof IItemPropertySource wrapper ? wrapper.getEditableValue(shown) : value;
    if (bare instanceof Enumerator literal) {
      return literal.getLiteral();
    }
    String text = property.getLabelProvider(shown).getText(value);
    return text == null ? "" : text;
  }

  private static void expand(TreeItem[] items) {
    for (TreeItem item : items) {
      item.setExpanded(true);
      expand(item.getItems());
    }
  }

  private static void save(Shell shell, String picture) {
    Image image = new Image(shell.getDisplay(), WIDTH, HEIGHT);
    GC graphics = new GC(shell);
    graphics.copyArea(image, 0, 0);
    graphics.dispose();
    ImageLoader loader = new ImageLoader();
    loader.data = new ImageData[] {image.getImageData()};
    loader.save(picture, SWT.IMAGE_PNG);
    image.dispose();
    shell.dispose();
  }
}
